"""The commands of XML that the commands of a script make: tables and tools."""

from pathlib import Path
from typing import NoReturn

from mpmcli.core.errors import Problem, SceneError
from mpmcli.importers.nairnmpm.commands import Command, Entity
from mpmcli.importers.nairnmpm.grammar import SHAPES
from mpmcli.importers.nairnmpm.language import Line
from mpmcli.importers.nairnmpm.script_values import Scalar, ScriptError, text_of

ANALYSES = {"plane strain mpm": 10, "plane stress mpm": 11, "3d mpm": 12, "axisymmetric mpm": 13}
METHODS = {"usf": 0, "usavg": 2, "usl": 3, "szs": 3}
NORMALS = {"maxgrad": 0, "maxvol": 1, "avggrad": 2, "owngrad": 3, "specify": 4, "linreg": 5, "logreg": 6}
_TYPES = {
    1: "isotropic",
    2: "transverse 1",
    3: "transverse 2",
    4: "orthotropic",
    7: "viscoelastic",
    8: "mooney",
    9: "vonmises, isoplasticity",
    10: "bistable",
    11: "rigid, rigidbc",
    12: "triangulartraction",
    13: "lineartraction",
    14: "cubictraction",
    15: "hillplastic",
    17: "mgeosmaterial, mgscglmaterial",
    20: "trilineartraction",
    21: "heanisotropic",
    22: "idealgas",
    23: "coupledtraction, coupledsawtooth",
    24: "heisotropic",
    25: "hemgeosmaterial",
    26: "pressuretraction",
    27: "taitliquid",
    28: "neohookean",
    29: "clampedneohookean",
    33: "mixedmodetraction",
    34: "exponentialtraction",
    35: "rigidcontact",
    50: "isosoftening",
    60: "ignorecontact",
    61: "coulombfriction",
    62: "linearinterface",
}
TYPES = {name: number for number, names in _TYPES.items() for name in names.split(", ")}
STYLES = {"constant": 1, "linear": 2, "sine": 3, "cosine": 4, "silent": 5, "function": 6}
AXES = {"x": 1, "y": 2, "z": 3, "normal": 11, "shear": 12, "skewxy": 12, "skewrz": 12, "external": 1}
PROPERTIES = {"a": "alpha", "ax": "alphax", "ay": "alphay", "az": "alphaz", "aa": "alphaA", "at": "alphaT"}
PROPERTIES |= {"ka": "kCondA", "kt": "kCondT", "kx": "kCondx", "ky": "kCondy", "kz": "kCondz"}
PROPERTIES |= {"direction": "SetDirection", "hardening": "Hardening", "matdamping": "PDamping"}
PROPERTIES |= {"temperature": "SetTemperature", "concentration": "SetConcentration"}
GROWTH = {"criterion", "direction", "altcriterion", "altdirection"}
"""Properties of a material that say how cracks grow in it."""
PLACES: dict[str, tuple[tuple[str, ...], int]] = {
    "line": (("x1", "y1", "x2", "y2", "tolerance"), 4),
    "arc": (("x1", "y1", "x2", "y2", "start", "end", "tolerance"), 6),
    "box": (("xmin", "ymin", "zmin", "xmax", "ymax", "zmax", "axis"), 6),
    "rect": (("xmin", "xmax", "ymin", "ymax"), 4),
}
CRITERIA = {
    "none": 0,
    "max energy release": 1,
    "steady state": 2,
    "energy balance": 3,
    "energy density": 4,
    "elliptical": 5,
    "max ctod": 6,
    "critical err": 7,
}
DIRECTIONS = {"default": 0, "self similar": 1, "cod normal": 2, "cod hoop": 3, "initial": 4}
SETTINGS = {
    "archive": ("ArchiveRoot", "ArchiveTime", "FirstArchiveTime"),
    "archiveunique": ("ArchiveRoot", "ArchiveTime", "FirstArchiveTime"),
    "archivetime": ("ArchiveTime", "FirstArchiveTime"),
    "cflfactor": ("TimeFactor",),
    "globalarchivetime": ("GlobalArchiveTime",),
    "leavelimit": ("LeaveLimit",),
    "maximumtime": ("MaxTime",),
    "stressfreetemp": ("StressFreeTemp",),
    "timestep": ("TimeStep", "MaxTime", "TimeFactor"),
}
"""The command of MPMHeader that each value of a script's command makes."""
HEATS = {
    "isothermal": "",
    "adiabatic": "EnergyCoupling",
    "mechanical energy": "EnergyCoupling",
    "crack tips": "CrackTipHeating",
    "friction": "ContactHeating",
    "crack friction": "CrackContactHeating",
}
"""The command of Thermal that each option of ``Conduction`` makes."""
TIMES = {"ArchiveTime", "FirstArchiveTime", "GlobalArchiveTime", "MaxTime", "TimeStep"}
"""Those of them that are times."""
HISTORIES = {
    "velocity": ("DisBC", 1, "vel"),
    "temperature": ("TempBC", 0, "value"),
    "load": ("LoadBC", 1, "load"),
    "traction": ("TractionBC", 2, "stress"),
    "heatflux": ("HeatFluxBC", 2, "value"),
}
"""The command that a condition makes, the values before its style, and what its value is called."""
_MOST = {
    0: "hole gridbc particlebc",
    1: "title name analysis ptsperelement loadtype boundaryid customtask contactposition frictionmm contactmm"
    " friction moveplane gridthickness done endregion endhole extrapolaterigid",
    2: "mpmmethod damping pdamping globalarchive polypt propagate altpropagate entity",
    3: "consistentunits feedbackdamping pfeedbackdamping material gravity growcrack jcontour parameter"
    " imperfectinterface imperfectinterfacemm bmpregion",
    4: "gridhoriz gridvert griddepth newcrack growcrackline loadrect temperature origin",
    5: "moveline loadline load heatflux multimaterialmode",
    6: "gridrect traction velocity rect oval box sphere rotate",
    7: "movearc loadarc movebox loadbox line arc",
    8: "cylinder torus",
}
MOST = {name: count for count, names in _MOST.items() for name in names.split()}
MOST |= {name: len(made) for name, made in SETTINGS.items()}
"""The values of a command that are read; more are refused. Public scripts give loads a last one that nothing reads."""

CUT = {"rect", "oval", "arc", "line", "polypt", "box", "sphere", "cylinder", "torus"}
"""Shapes that ``Cut`` takes out of the shape before."""
NAMES = ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")


class Base:
    """The tree of commands that a script has made so far."""

    def __init__(self, path: Path):
        self.path = path
        self.line: int | None = None
        self.root = Command("JANFEAInput", {}, 1)
        self.blocks: dict[str, Command] = {}
        self.ids: dict[str, str] = {}
        self.entities: dict[str, Entity] = {}
        self.material: Command | None = None
        self.body: Command | None = None
        self.polygon: Command | None = None
        self.shape: Command | None = None
        self.crack: Command | None = None
        self.task: Command | None = None
        self.crack_end: tuple[Scalar, Scalar] = (0.0, 0.0)
        self.boundary: Scalar | None = None  # the number of the conditions that follow
        self.is_3d = self.is_axisymmetric = False
        self.ms: dict[str, Scalar] = {"units": "ms"}  # of times, unless the script declares units
        self.description: list[str] = []
        self.axes: dict[str, dict[str, str]] = {}
        self.grid: dict[str, str] = {}
        for word in ("Header", "MPMHeader", "Mesh", "MaterialPoints"):
            self._block(word)

    def refuse(self, line: int, words: str) -> NoReturn:
        raise SceneError([Problem("script", words, str(self.path), line, code="source")])

    def _block(self, name: str) -> Command:
        if name not in self.blocks:
            self.blocks[name] = Command(name, {}, self.line or 1)
            self.root.children.append(self.blocks[name])
        return self.blocks[name]

    def _add(self, parent: Command, word: str, text: Scalar = "", /, **attributes: Scalar) -> Command:
        made = Command(word, {k: text_of(v) for k, v in attributes.items()}, self.line or 1, text_of(text))
        parent.children.append(made)
        return made

    def _set(self, word: str, text: Scalar = "", /, **attributes: Scalar) -> Command:
        return self._add(self._block("MPMHeader"), word, text, **attributes)

    def _need(self, line: Line, count: int) -> tuple[Scalar, ...]:
        if len(line.values) < count:
            raise ScriptError(f"'{line.text[:40]}' needs {count} values at least")
        return line.values

    def _choice(self, value: Scalar, table: dict[str, int], what: str) -> int:
        if isinstance(value, float):
            return round(value)
        if value.lower() not in table:
            raise ScriptError(f"not supported: the {what} '{value}'")
        return table[value.lower()]

    def _number_of(self, key: str) -> str:
        """The number of a material by its name in the script."""
        return str(list(self.ids).index(key) + 1)

    def _named(self, key: str, word: str = "mat") -> dict[str, str]:
        """The attribute that names a material by its number, or one that is not defined by the script's name."""
        return {word: self._number_of(key)} if key in self.ids else {f"{word}name": key}

    def _into(self, level: int = 0) -> Command:
        """The open region or condition; for cuts the last shape in it, or in that shape, by their level."""
        found = self.body or self.shape
        if found is None:
            raise ScriptError("a shape outside a region")
        for _ in range(level):
            last = [inside for inside in found.children if inside.name in SHAPES.split()]
            if not last:
                raise ScriptError("'Cut' without a shape before it")
            found = last[-1]
        return found
