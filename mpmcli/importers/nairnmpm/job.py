"""What the parts of a translation share: the source, the scene being made, units, the grid, names, and notes."""

import re
from dataclasses import dataclass, field, replace
from typing import Any

from mpmcli.importers.base import NoteKind, Translation, free_name
from mpmcli.importers.nairnmpm import expressions
from mpmcli.importers.nairnmpm.commands import Command, CommandFile
from mpmcli.importers.nairnmpm.values import PLAIN, Formula, Unit, Value, read

ROOT_OF_METER = 31.622776601683793
"""Square root of 1 m in mm, of stress intensities."""

LEGACY = {
    "acceleration": Unit("mm/s^2", 1e-6),
    "conductivity": Unit("W/(m K)", 1e-3),
    "density": Unit("g/cm^3", 1e-3),
    "energy_rate": Unit("J/m^2", 1e-3),
    "expansion": Unit("", 1e-6),
    "flux": Unit("W/m^2", 1e-6),
    "frequency": Unit("1/s", 1e-3),
    "kinetic": Unit("uJ", 1e-3),
    "stress_intensity": Unit("", ROOT_OF_METER),
    "time": Unit("s", 1e3),
    "velocity": Unit("mm/s", 1e-3),
    "viscosity": Unit("cP", 1e-6),
}
"""Units of NairnMPM that are not those of a scene in mm, g and ms, where forces are N and stresses MPa.

Files with consistent units have them for expansions only, which are always 1e-6/K.
"""
_LENGTHS = {"m": 1e3, "cm": 10.0, "microns": 1e-3, "in": 25.4, "ft": 304.8}
_TIMES = {"msec": 1e-3, "ms": 1e-3, "microsec": 1e-6, "us": 1e-6}
_VELOCITIES = {"m/sec": 1e3, "mm/msec": 1e3, "cm/sec": 10.0, "in/sec": 25.4, "ft/sec": 304.8}


@dataclass
class Material:
    """A material of the source: its name in the scene, and what the rest of the translation asks for."""

    key: str
    kind: int
    command: Command
    title: str
    used: bool = False
    idle: bool = False
    """Whether its bodies are rigid and without effect."""
    direction: int = 0
    """Directions in which a rigid material holds nodes: 1 x, 2 y, 4 z, their sums; 8: contact."""

    @property
    def is_rigid(self) -> bool:
        """Whether its bodies are rigid."""
        return self.kind in {11, 35}


@dataclass
class Job:
    """One translation."""

    source: CommandFile
    made: Translation
    scene: dict[str, Any] = field(default_factory=dict)
    analysis: str = "plane_strain"
    legacy: bool = True
    lower: list[float] = field(default_factory=list)
    upper: list[float] = field(default_factory=list)
    cell: list[float] = field(default_factory=list)
    materials: list[Material] = field(default_factory=list)
    """In the order of NairnMPM's numbers."""
    heats: bool = False
    """Whether temperatures matter."""
    tips: dict[str, int] = field(default_factory=dict)
    """Ends of cracks that have a material at their tip, ``crack:end``; NairnMPM finds J and growth of no others."""
    shape: str = "linear"
    conditions: list[tuple[int, dict[str, Any]]] = field(default_factory=list)
    """Conditions of velocities on nodes, by the number (``id``) that reactions have."""

    @property
    def axes(self) -> str:
        """Names of the axes."""
        return "xyz" if self.analysis == "3d" else "xy"

    @property
    def tolerance(self) -> float:
        """A small length: the least difference between coordinates that matters."""
        return 1e-6 * min(self.cell)

    # ---------------------------------------------------------------- numbers

    def unit(self, quantity: str) -> Unit:
        """The unit of a quantity in the source."""
        return LEGACY.get(quantity, PLAIN) if self.legacy or quantity == "expansion" else PLAIN

    def number(
        self, command: Command, attribute: str | None, quantity: str = "", shown: bool = False
    ) -> Value | None:
        """An attribute of a command, or its text, as a number; None if it is not there or is not a number."""
        text = command.text if attribute is None else command.get(attribute)
        if text is None or not text.strip():
            return None
        unit = self.unit(quantity)
        if (units := command.attributes.get("units")) is not None:
            command.get("units")
            unit = self._with_units(command, units, quantity, unit)
        try:
            value = read(text, unit, shown, self.source)
        except ValueError:
            return None  # said by the check of the grammar
        plain = self.source.plain(text).strip()
        if plain and not re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", plain):
            self.note("changed", command, f"'{plain[:40]}' is read as {value.number:g}, as NairnMPM does")
        return replace(value, line=command.line)

    def plain(self, command: Command, attribute: str | None, default: float = 0.0) -> float:
        """An attribute of a command, or its text, as a number without a unit."""
        value = self.number(command, attribute)
        return default if value is None else value.number

    def property(self, command: Command, name: str, quantity: str = "", shown: bool = False) -> Value | None:
        """The number in a command inside this one."""
        inside = command.last(name)
        return None if inside is None else self.number(inside, None, quantity, shown)

    def needed(
        self, command: Command, name: str, quantity: str = "", shown: bool = False, why: str = ""
    ) -> Value | None:
        """The number in a command inside this one; an error without it."""
        value = self.property(command, name, quantity, shown)
        if value is None:
            self.error(command, f"the command <{name}> is missing{why}")
        return value

    def properties(self, command: Command, names: dict[str, str]) -> dict[str, Any]:
        """Those numbers in commands inside this one that are there, by their names in the scene."""
        found = {ours: self.property(command, theirs) for theirs, ours in names.items()}
        return {ours: value for ours, value in found.items() if value is not None}

    def code(self, command: Command, name: str, default: int) -> int:
        """The number in a command inside this one, rounded; the default without it."""
        inside = command.last(name)
        return default if inside is None else round(self.plain(inside, None))

    def word(self, command: Command | None, default: str = "") -> str:
        """The text of a command, or the default without it."""
        return default if command is None else self.source.plain(command.text).strip()

    def _with_units(self, command: Command, units: str, quantity: str, unit: Unit) -> Unit:
        table = {"time": _TIMES, "velocity": _VELOCITIES}.get(quantity, _LENGTHS)
        if units not in table:
            return unit
        factor = unit.factor * table[units]
        if quantity == "time" and self.legacy:
            return PLAIN if units in {"ms", "msec"} else Unit("", factor)
        return Unit("", factor)

    def amount(self, command: Command, names: str, quantity: str = "") -> Value | None:
        """The first of several attributes that is there; all of them count as read."""
        values = [self.number(command, name, quantity) for name in names.split()]
        return next((value for value in values if value is not None), None)

    def formula(self, command: Command, text: str, quantity: str = "", time: str = "t") -> Formula | None:
        """An expression of the source with the factor to the scene's unit, or None after an error."""
        try:
            made = expressions.translate(text, time, self.analysis == "axisymmetric")
        except expressions.NotTranslated as error:
            words = f"expression '{self.source.plain(text).strip()[:60]}': {error}"
            if "has no counterpart" in str(error) or "not a variable" in str(error):
                self.note("not_supported", command, words)
            else:
                self.error(command, words)
            return None
        return Formula(made, self.unit(quantity).factor, command.line)

    def check_style(self, command: Command) -> tuple[int, Value | None, str | None]:
        """Style of a condition, its time argument, and its function."""
        style = round(self.plain(command, "style", 1.0))
        when = command.get("ftime") if "ftime" in command.attributes else command.get("time")
        bath = command.get("bath")
        value = None
        if when is not None or bath is not None:
            value = read(when or bath or "0", PLAIN, source=self.source)
        return style, value, command.get("function")

    # ------------------------------------------------------------------ notes

    def note(self, kind: NoteKind, command: Command, words: str) -> None:
        """A note about a command."""
        self.made.note(kind, command.line, f"<{command.name}>", words)

    def error(self, command: Command, words: str) -> None:
        """This command is a fault of the source."""
        self.made.error(command.line, f"<{command.name}>", words)

    def unsupported(self, command: Command, words: str, inside: str = "") -> None:
        """The scene lacks this command, or those inside it of these names; what is in them needs no words."""
        self._skipped("not_supported", command, words, inside)

    def ignored(self, command: Command, words: str, inside: str = "") -> None:
        """This command, or those inside it of these names, have no effect on the motion."""
        self._skipped("ignored", command, words, inside)

    def _skipped(self, kind: NoteKind, command: Command, words: str, inside: str) -> None:
        for skipped in command.all(*inside.split()) if inside else (command,):
            skipped.skip()
            self.note(kind, skipped, words)

    def changed(self, command: Command, words: str) -> None:
        """This command has another meaning or default here."""
        self.note("changed", command, words)

    # -------------------------------------------------------------- materials

    def material(self, command: Command) -> Material | None:
        """The material that a command names by ``matname`` or counts by ``mat``; None after an error."""
        found = self.find_material(command)
        if found is None:
            named, number = command.attributes.get("matname"), command.attributes.get("mat")
            if named is not None:
                names = ", ".join(material.command.attributes.get("Name", "") for material in self.materials)
                words = f"no material '{self.source.plain(named)}' (there are: {names})"
            elif number or command.attributes.get("matl") or command.attributes.get("material"):
                words = f"no material {self.source.plain(number or '')}; the file has {len(self.materials)}"
            else:
                words = "a material is missing: matname or mat"
            self.error(command, words)
        return found

    def find_material(self, command: Command) -> Material | None:
        """The material that a command names by ``matname`` or counts by ``mat``, or None."""
        name = command.get("matname")
        texts = [command.get(word) for word in ("mat", "matl", "material")]
        if name is not None:
            plain = self.source.plain(name)
            return next((m for m in self.materials if m.title == plain), None)
        number = next((text for text in texts if text), "")
        try:
            index = round(read(number, source=self.source).number)
        except (ValueError, OverflowError):
            return None
        return self.materials[index - 1] if 1 <= index <= len(self.materials) else None

    # ------------------------------------------------------------ coordinates

    def coordinate(self, command: Command, attribute: str, axis: int) -> Value | None:
        """A coordinate: a number, or ``min-``, ``max+2`` in cells from a side of the grid."""
        text = self.source.plain(command.get(attribute) or "").strip()
        if not text.startswith("m"):
            return self.number(command, attribute)
        side = self.upper[axis] if text.startswith("max") else self.lower[axis]
        rest = text[3:].strip()
        if rest in {"+", "-"}:
            rest += "1"
        return Value(side + (float(rest) if rest else 0.0) * min(self.cell))


def slug(text: str, taken: set[str]) -> str:
    """A name for a scene: lower case, with underscores; another one if it is taken."""
    name = re.sub(r"\W+", "_", text.lower()).strip("_")[:60] or "unnamed"
    if name[0].isdigit():
        name = f"m{name}"
    made = free_name(name, taken)
    taken.add(made)
    return made
