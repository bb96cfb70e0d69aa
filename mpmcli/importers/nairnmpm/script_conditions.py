"""Conditions and cracks of a script."""

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.language import Line
from mpmcli.importers.nairnmpm.script_base import AXES, CRITERIA, DIRECTIONS, HISTORIES, PLACES, STYLES, Base
from mpmcli.importers.nairnmpm.script_values import Scalar, ScriptError, text_of


class Conditions(Base):
    """Moved and loaded places, gravity, and cracks."""

    # -------------------------------------------------------------- conditions

    def _do_moveline(self, line: Line) -> None:
        block = "GridBCs" if line.name.startswith("move") else "ParticleBCs"
        kind = line.name.removeprefix("move").removeprefix("load")
        names, count = PLACES[kind]
        values = self._need(line, count)
        given = dict(zip(names, values, strict=False))
        if "axis" in given:
            given["axis"] = float(self._choice(given["axis"], {"x": 1, "y": 2, "z": 3}, "axis"))
        if given.get("tolerance") in {0.0, -1.0}:
            del given["tolerance"]
        word = "LdRect" if kind == "rect" else f"BC{kind.title()}"
        self.shape = self._add(self._block(block), word, **given)

    _do_movearc = _do_movebox = _do_loadline = _do_loadarc = _do_loadrect = _do_loadbox = _do_moveline

    def _do_gridbc(self, line: Line) -> None:
        block = "GridBCs" if line.name == "gridbc" else "ParticleBCs"
        self.shape = self._add(self._block(block), "BCShape")

    _do_particlebc = _do_gridbc

    def _do_endmoveline(self, line: Line) -> None:
        self.shape = self.polygon = None

    _do_endmovearc = _do_endmovebox = _do_endloadline = _do_endloadarc = _do_endmoveline
    _do_endloadrect = _do_endloadbox = _do_endgridbc = _do_endparticlebc = _do_endmoveline

    def _do_boundaryid(self, line: Line) -> None:
        self.boundary = line.values[0] if line.values else None

    def _do_loadtype(self, line: Line) -> None:
        words = {"net": "net", "perparticle": "perParticle"}
        word = text_of(self._need(line, 1)[0]).lower()
        if word not in words:
            raise ScriptError(f"'{word[:30]}' is not a type of load: net or perParticle")
        self._add(self._into(), words[word])

    def _history(self, line: Line) -> None:
        name, skip, key = HISTORIES[line.name]
        values = self._need(line, skip + 1)
        style = self._choice(values[skip], STYLES, "style")
        made = self._add(self._into(), name, style=float(style))
        if skip:
            axes = AXES | ({"r": 1, "z": 2} if self.is_axisymmetric else {})
            made.attributes["dir"] = str(self._choice(values[0], axes, "direction"))
        rest = values[skip + 1 :]
        if style == 6:
            made.attributes["function"] = text_of(self._need(line, skip + 2)[skip + 1])
        elif rest:
            made.attributes[key] = text_of(rest[0])
        if len(rest) > 1:
            made.attributes["time"] = text_of(rest[1])
        if name == "DisBC":
            made.attributes |= {"id": text_of(self.boundary)} if self.boundary else {}
            made.attributes |= {k: text_of(v) for k, v in zip(("angle", "angle2"), values[4:], strict=False)}
        if skip == 2:
            made.attributes["face"] = text_of(values[1])

    def _do_gravity(self, line: Line) -> None:
        earth = (0.0, -9806.65 if self.ms else -9.80665, 0.0)
        for axis, value in zip("XYZ", line.values + earth[len(line.values) :], strict=True):
            name = f"GridBody{axis}Force" if isinstance(value, str) else f"Body{axis}Force"
            self._add(self._block("Gravity"), name, value)

    # ------------------------------------------------------------------ cracks

    def _cracks(self) -> Command:
        return self.blocks["MPMHeader"].first("Cracks") or self._set("Cracks")

    def _choice_of_friction(self, value: Scalar) -> Scalar:
        number = {"none": 0.0, "stick": -5.0, "single": -11.0, "ignore": -11.0}.get(
            text_of(value).lower(), value
        )
        if isinstance(number, str):
            raise ScriptError(f"not supported: the friction '{number[:40]}'")
        return number

    def _do_moveplane(self, line: Line) -> None:
        self._add(self._cracks(), "MovePlane", type=self._need(line, 1)[0])

    def _tip(self, value: Scalar) -> str:
        word = text_of(value)
        if word.lower() == "exterior":
            return "-2"
        if word not in self.ids:
            raise ScriptError(f"the material '{word[:40]}' of the tip is not defined")
        return self._number_of(word)

    def _do_newcrack(self, line: Line) -> None:
        x, y, *more = self._need(line, 2)
        self.crack = self._add(self.root, "CrackList")
        point = self._add(self.crack, "pt", x=x, y=y)
        self.crack_end = (x, y)
        word = text_of(more[0]) if more else "free"
        if word.lower() == "fixed":
            self.crack.attributes["type"] = "fixed"
        elif word.lower() != "free":
            point.attributes["tip"] = self._tip(word)
        if len(more) > 1:
            law = text_of(more[1])
            if law in self.ids:
                self.crack.attributes |= self._named(law, "law")
            else:
                self.crack.attributes["friction"] = text_of(self._choice_of_friction(more[1]))

    def _do_growcrack(self, line: Line) -> None:
        x, y, *more = self._need(line, 2)
        if self.crack is None:
            raise ScriptError("'NewCrack' must come first")
        if line.name == "growcrack":
            made = self._add(self.crack, "pt", x=x, y=y)
            tip, word = more[:1], "tip"
        else:
            start = self.crack_end
            made = self._add(self.crack, "Line", xmin=start[0], ymin=start[1], xmax=x, ymax=y)
            made.attributes["resolution"] = text_of(more[0]) if more else "1"
            tip, word = more[1:2], "end_tip"
        if tip:
            made.attributes[word] = self._tip(tip[0])
        self.crack_end = (x, y)

    _do_growcrackline = _do_growcrack

    def _do_jcontour(self, line: Line) -> None:
        names = ("size", "terms", "gridenergy")
        made = self._add(self._cracks(), "JContour", type=1.0)
        made.attributes |= {k: text_of(v) for k, v in zip(names, self._need(line, 1), strict=False)}
        if "gridenergy" in made.attributes:
            table = {"no": 0, "false": 0, "yes": 1, "true": 1}
            made.attributes["gridenergy"] = str(self._choice(line.values[2], table, "energy of the grid"))

    def _do_propagate(self, line: Line) -> None:
        made = self._add(self._cracks(), "Propagate" if line.name == "propagate" else "AltPropagate")
        values = self._need(line, 1)
        made.attributes["criterion"] = str(self._choice(values[0], CRITERIA, "criterion"))
        if len(values) > 1:
            made.attributes["direction"] = str(self._choice(values[1], DIRECTIONS, "direction"))

    _do_altpropagate = _do_propagate
