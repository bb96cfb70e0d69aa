"""Scripts of NairnFEAMPM and NairnFEAMPMViz as the XML commands that they make."""

import re
from collections.abc import Callable
from pathlib import Path

from mpmcli.importers.nairnmpm import script_base as tables
from mpmcli.importers.nairnmpm.commands import CLOSE, NUMBER, OPEN, Command, CommandFile, Entity, parse
from mpmcli.importers.nairnmpm.language import Line, run
from mpmcli.importers.nairnmpm.script_bodies import Regions
from mpmcli.importers.nairnmpm.script_conditions import Conditions
from mpmcli.importers.nairnmpm.script_values import Scalar, ScriptError, text_of

_REFERENCE = re.compile(r"&(?!(?:amp|lt|gt|quot|apos);)([A-Za-z_]\w*);")


def read(contents: bytes, path: Path) -> CommandFile:
    """The commands that a script makes.

    Raises SceneError with the line of the first command that cannot be run or is not known.
    """
    maker = _Maker(path)
    try:
        for line in run(contents.decode("utf-8", errors="replace")):
            maker.take(line)
        maker.finish()
    except ScriptError as error:
        maker.refuse(error.line or maker.line or 1, str(error))
    return CommandFile(maker.root, maker.entities)


class _Maker(Regions, Conditions):
    def __init__(self, path: Path):
        super().__init__(path)
        self.handlers: dict[str, Callable[[Line], None]] = {
            **{name[4:]: getattr(self, name) for name in dir(self) if name.startswith("_do_")},
            **dict.fromkeys(tables.SETTINGS, self._settings),
            **dict.fromkeys(tables.HISTORIES, self._history),
        }

    def take(self, line: Line) -> None:
        """One command of the script."""
        self.line = line.number
        if self.material is not None and line.name != "done":
            self._property(line)
            return
        if line.level and line.name not in tables.CUT:
            raise ScriptError(f"'Cut' needs a shape, not '{line.name[:40]}'")
        handler = self.handlers.get(line.name)
        if handler is None:
            self.refuse(line.number, f"not supported: the script command '{line.text.split(' ')[0][:40]}'")
        if len(line.values) > tables.MOST.get(line.name, len(line.values)):
            given = text_of(line.values[tables.MOST[line.name]])
            raise ScriptError(f"not supported: the value '{given[:40]}' of '{line.text.split(' ')[0]}'")
        handler(line)

    def finish(self) -> None:
        """Close what the end of a script closes."""
        for command in self.root.walk():
            command.text = self._resolved(command.text)
            command.attributes = {name: self._resolved(text) for name, text in command.attributes.items()}
        header = self.blocks["Header"]
        if self.description:
            self._add(header, "Description", "\n".join(self.description))
        mesh = Command("Grid", self.grid, self.line or 1)
        for name, attributes in self.axes.items():
            mesh.children.append(Command(name, attributes, self.line or 1))
        self.blocks["Mesh"].children.append(mesh)

    def _resolved(self, text: str) -> str:
        """A text with the values of entities, or their marks where they are numbers."""

        def value(found: re.Match[str]) -> str:
            entity = self.entities.get(found[1])
            if entity is None:
                return found[0]
            number = NUMBER.match(entity.value)
            is_number = number is not None and number.end() == len(entity.value.rstrip())
            return f"{OPEN}{found[1]}{CLOSE}" if is_number else entity.value

        return _REFERENCE.sub(value, text)

    def _do_entity(self, line: Line) -> None:
        name, value = map(text_of, self._need(line, 2))
        self.entities[name] = Entity(name, value, line.number)

    # ------------------------------------------------------------------ header

    def _do_title(self, line: Line) -> None:
        at = 0 if line.name == "title" else len(self.description)
        self.description.insert(at, f"{line.name.title()}: {text_of(self._need(line, 1)[0])}")

    _do_name = _do_title

    def _do_header(self, line: Line) -> None:
        self.description += str(line.values[1]).splitlines()

    def _do_comment(self, line: Line) -> None:
        self.description.append("Comment: " + ", ".join(map(text_of, line.values)))

    def _do_processors(self, line: Line) -> None:
        self._add(self.blocks["Header"], "Processors", self._need(line, 1)[0])

    def _do_analysis(self, line: Line) -> None:
        code = self._choice(self._need(line, 1)[0], tables.ANALYSES, "analysis")
        self.is_3d, self.is_axisymmetric = code == 12, code == 13
        self._add(self.blocks["Header"], "Analysis", float(code))

    def _do_consistentunits(self, line: Line) -> None:
        self.ms = {}
        units = dict(zip(("length", "mass", "time"), line.values or ("m", "kg", "s"), strict=False))
        self._add(self.blocks["Header"], "ConsistentUnits", **units)

    def _do_mpmmethod(self, line: Line) -> None:
        word = text_of(self._need(line, 1)[0]).lower()
        self._set("MPMMethod", float(self._choice(word.rstrip("+-"), tables.METHODS, "method")))
        if word.endswith("-"):
            self._set("SkipPostExtrapolation")
        if len(line.values) > 1:
            self._set("GIMP", type=line.values[1])

    def _settings(self, line: Line) -> None:
        for name, value in zip(tables.SETTINGS[line.name], self._need(line, 1), strict=False):
            self._set(name, value, **(self.ms if name in tables.TIMES else {}))

    def _do_ptsperelement(self, line: Line) -> None:
        count = self._need(line, 1)[0]
        if self.body is not None:
            raise ScriptError("not supported: 'PtsPerElement' inside a region")
        if isinstance(count, float) and 1 <= count <= (3 if self.is_3d else 5):
            count = count ** (3 if self.is_3d else 2)  # larger ones are totals, of old scripts
        self._set("MatlPtsPerElement", count)

    def _do_globalarchive(self, line: Line) -> None:
        values = self._need(line, 1)
        owner = {}
        if len(values) > 1:
            word = text_of(values[1])
            is_number = isinstance(values[1], float) and word not in self.ids
            owner = {"mat": word} if is_number else self._named(word)
        self._set("GlobalArchive", type=values[0], **owner)

    def _do_toarchive(self, line: Line) -> None:
        for value in line.values:
            self._set("MPMArchive", result=text_of(value).strip())

    def _do_damping(self, line: Line) -> None:
        value, *share = self._need(line, 1)
        name = "PDamping" if line.name == "pdamping" else "Damping"
        function = {"function": value} if isinstance(value, str) else {}
        self._set(name, 0.0 if function else value, **function, **({"PIC": share[0]} if share else {}))

    _do_pdamping = _do_damping

    def _do_feedbackdamping(self, line: Line) -> None:
        more = dict(zip(("target", "max"), line.values[1:], strict=False))
        name = "PFeedbackDamping" if line.name.startswith("p") else "FeedbackDamping"
        self._set(name, self._need(line, 1)[0], **more)

    _do_pfeedbackdamping = _do_feedbackdamping

    def _do_extrapolaterigid(self, line: Line) -> None:
        if not line.values or text_of(line.values[0]).lower() == "yes":
            self._set("ExtrapolateRigid")

    def _do_xmldata(self, line: Line) -> None:
        words = [word.strip().strip('"') for word in text_of(line.values[0]).split(",")]
        where, key = words[0], "".join(words[1:2])
        text = _REFERENCE.sub(r"&amp;\1;", text_of(line.values[1]))  # entities stay until the end
        found = parse(f"<x>{text}</x>".encode(), self.path).root
        for command in found.walk():
            command.line += line.number
        if where.lower() in {"", "end", "material"}:
            self.root.children += found.children
        else:
            self._block(where).children += found.children
        if where.lower() == "material":
            material = found.first("Material")
            if not key or material is None or len(found.children) > 1:
                raise ScriptError("'XMLData' needs the name of its only material")
            self.ids[key] = material.attributes.get("Name", key)

    # ----------------------------------------------------------------- contact

    def _do_multimaterialmode(self, line: Line) -> None:
        values = line.values
        mode = self._set("MultiMaterialMode", Normals=2.0)
        if values:
            mode.attributes["Vmin"] = text_of(values[0])
        if len(values) > 1:
            checks = {"disabled": 0, "no": 0, "enabled": 1, "yes": 1}
            mode.attributes["Dcheck"] = str(self._choice(values[1], checks, "check of displacements"))
        if len(values) > 2:
            mode.attributes["Normals"] = text_of(float(self._choice(values[2], tables.NORMALS, "normal")))
        if len(values) > 3:
            names = ("Azimuth", "Polar") if mode.attributes["Normals"] == "4" else ("RigidBias",)
            if len(values) > 3 + len(names):
                raise ScriptError(
                    f"not supported: the value '{text_of(values[4])[:40]}' of 'MultimaterialMode'"
                )
            mode.attributes |= {name: text_of(v) for name, v in zip(names, values[3:], strict=False)}

    def _mode(self) -> Command:
        mode = self.blocks["MPMHeader"].first("MultiMaterialMode")
        if mode is None:
            raise ScriptError("'MultimaterialMode' must come before its choices")
        return mode

    def _do_contactposition(self, line: Line) -> None:
        self._add(self._mode(), "ContactPosition", self._need(line, 1)[0])

    def _do_friction(self, line: Line) -> None:
        friction = self._choice_of_friction(self._need(line, 1)[0])
        self._add(self._cracks() if line.name == "friction" else self._mode(), "Friction", friction)

    _do_frictionmm = _do_friction

    def _do_imperfectinterface(self, line: Line) -> None:
        names = ("Dt", "Dnt" if len(line.values) > 2 else "Dn", "Dnc")
        parent = self._cracks() if line.name == "imperfectinterface" else self._mode()
        self._add(parent, "Friction", 11.0, **dict(zip(names, self._need(line, 2), strict=False)))

    _do_imperfectinterfacemm = _do_imperfectinterface

    def _do_contactcracks(self, line: Line) -> None:
        law = text_of(self._need(line, 1)[0])
        parent = self._cracks() if line.name == "contactcracks" else self._mode()
        self._add(parent, "Friction", **self._named(law, "law"))

    _do_contactmm = _do_contactcracks

    # --------------------------------------------------------------- materials

    def _do_material(self, line: Line) -> None:
        values = self._need(line, 3)
        key = text_of(values[0])
        kind = self._choice(values[2], tables.TYPES, "material")
        name = text_of(values[1])
        taken = set(self.ids.values())
        self.ids[key] = name if name not in taken else f"{name} ({key})"
        self.material = self._add(self.root, "Material", Type=float(kind), Name=self.ids[key])

    def _do_done(self, line: Line) -> None:
        if self.material is None:
            raise ScriptError("'Done' without 'Material'")
        self.material = None

    def _property(self, line: Line) -> None:
        assert self.material is not None
        word = line.text.split(None, 1)[0].rstrip(",")
        name = tables.PROPERTIES.get(word.lower(), word)
        if word.lower() == "color":
            self._add(self.material, "color")
            return
        if word.lower() in tables.GROWTH and not (word.lower() == "direction" and self._is_rigid()):
            self._growth(word.lower(), self._need(line, 1)[0])
            return
        if word.lower() in {"friction", "contact"}:
            self._pair(word.lower(), self._need(line, 2))
            return
        if len(line.values) > 1:
            raise ScriptError(f"not supported: several values of '{word}'")
        if word.lower().startswith("settingfunction"):
            name = "SettingFunction" + {"x": "", "y": "2", "z": "3"}.get(word[15:].lower(), word[15:])
        self._add(self.material, name, line.values[0] if line.values else "")

    def _is_rigid(self) -> bool:
        return self.material is not None and self.material.attributes["Type"] == "11"

    def _growth(self, word: str, value: Scalar) -> None:
        """The criterion or the direction of the growth of cracks in a material."""
        assert self.material is not None
        name = "AltPropagate" if word.startswith("alt") else "Propagate"
        made = self.material.first(name) or self._add(self.material, name)
        key = word.removeprefix("alt")
        table = tables.CRITERIA if key == "criterion" else tables.DIRECTIONS
        made.attributes[key] = str(self._choice(value, table, key))

    def _pair(self, word: str, values: tuple[Scalar, ...]) -> None:
        """Contact of a material with another one."""
        assert self.material is not None
        law, other = values[0], text_of(values[1])
        if len(values) > 2 or other not in self.ids:
            raise ScriptError(f"the material '{text_of(values[-1])[:40]}' of '{word}' is not defined")
        made = self._add(self.material, "Friction", mat=self._number_of(other))
        if word == "contact":
            made.attributes |= self._named(text_of(law), "law")
        else:
            made.text = text_of(self._choice_of_friction(law))

    # -------------------------------------------------------------------- grid

    def _do_gridhoriz(self, line: Line) -> None:
        name = line.name.removeprefix("grid").title()
        count = {"Horiz": "nx", "Vert": "ny", "Depth": "nz"}[name]
        values = self._need(line, 1)
        if any(isinstance(value, str) for value in values):
            raise ScriptError("not supported: cells that grow (R-Style)")
        made = {count: text_of(values[0])}
        first, second = ("symmax", "symmin") if values[2:3] == (1.0,) else ("symmin", "symmax")
        made |= {k: text_of(v) for k, v in zip((first, second), values[1:2] + values[3:4], strict=False)}
        self.axes[name] = made

    _do_gridvert = _do_griddepth = _do_gridhoriz

    def _do_gridrect(self, line: Line) -> None:
        self.grid |= {k: text_of(v) for k, v in zip(tables.NAMES, self._need(line, 4), strict=False)}

    def _do_gridthickness(self, line: Line) -> None:
        self.grid["thickness"] = text_of(self._need(line, 1)[0])

    # ------------------------------------------------------------------- tasks

    def _do_conduction(self, line: Line) -> None:
        first, *more = (text_of(value).lower() for value in self._need(line, 1))
        if first not in {"yes", "no"}:
            raise ScriptError(f"'{first[:40]}' of 'Conduction' is neither yes nor no")
        for word in more:
            if word not in tables.HEATS:
                raise ScriptError(f"not supported: the option '{word[:40]}' of 'Conduction'")
        made = {"Conduction"} if first == "yes" else set()
        for name in [*sorted(made), *dict.fromkeys(tables.HEATS[word] for word in more)]:
            if name:
                self._add(self._block("Thermal"), name)

    def _do_customtask(self, line: Line) -> None:
        self.task = self._add(self._block("CustomTasks"), "Schedule", name=self._need(line, 1)[0])

    def _do_parameter(self, line: Line) -> None:
        if self.task is None:
            raise ScriptError("'CustomTask' must come first")
        name, *more = self._need(line, 1)
        if self.task.attributes["name"] == "ReverseLoad" and more:
            if name == "quantity":
                name, more = f"global {text_of(more[0])}", []
            elif name == "material":
                key = text_of(more[0])
                name, more = "mat", [self._number_of(key) if key in self.ids else more[0]]
        self._add(self.task, "Parameter", more[0] if more else "", name=name)

    def _do_stop(self, line: Line) -> None:
        raise ScriptError(f"the script stops: {text_of(line.values[0]) if line.values else ''}")
