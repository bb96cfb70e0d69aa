"""Regions, holes and pictures of a script, and the shapes in them."""

from mpmcli.importers.nairnmpm import script_base as tables
from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.language import Line
from mpmcli.importers.nairnmpm.script_base import Base
from mpmcli.importers.nairnmpm.script_values import Scalar, ScriptError, number_of, text_of

_OF_LEVEL = {"thick": "Thickness", "temp": "Temperature", "angle": "Angle", "conc": "Concentration"}
"""The command that each property of an intensity makes."""


class Regions(Base):
    """Regions and shapes."""

    def _do_region(self, line: Line) -> None:
        values = self._need(line, 1)
        key = text_of(values[0])
        names = ("vx", "vy", "vz" if self.is_3d else "thick")
        given: dict[str, Scalar] = dict(zip(names, values[1:4], strict=False))
        for name, value in zip(values[4::2], values[5::2], strict=False):
            given[text_of(name).lower()] = value
        if len(values) > 4 and len(values) % 2 == 1:
            raise ScriptError(f"the property '{text_of(values[-1])[:40]}' has no value")
        moving = {name: given.pop(name) for name in ("vx", "vy", "vz") if isinstance(given.get(name), str)}
        self.body = self._add(self.blocks["MaterialPoints"], "Body", **self._named(key), **given)
        for name, value in moving.items():
            self._add(self.body, f"vel0{name[1].upper()}", value)
        self.polygon = None

    def _do_hole(self, line: Line) -> None:
        self.body = self._add(self.blocks["MaterialPoints"], "Hole")

    def _do_endregion(self, line: Line) -> None:
        self.body = self.polygon = None

    _do_endhole = _do_endregion

    def _do_transform(self, line: Line) -> None:
        values = self._need(line, 1)
        if self.body is None or self.body.name != "Body":
            raise ScriptError("'Transform' belongs into a region")
        if self.body.first("Transform") is not None:
            raise ScriptError("only one 'Transform' is allowed in a region")
        if self.is_3d or len(values) > 5:
            raise ScriptError("not supported: 'Transform' in 3D")
        names = ("angle", "tx", "ty", "ox", "oy")
        self._add(self.body, "Transform", **dict(zip(names, values, strict=False)))

    def _do_rotate(self, line: Line) -> None:
        """Turns of the axes of the material."""
        values = self._need(line, 1)
        if self.body is None or self.body.name == "Hole":
            raise ScriptError("'Rotate' belongs into a region")
        if text_of(values[0]).lower() == "reset":
            self._add(self.body, "Unrotate")
            return
        for axis, angle in zip(values[::2], self._need(line, 2)[1::2], strict=False):
            number = self._choice(axis, {"x": 1, "y": 2, "z": 3}, "axis")
            self._add(self.body, f"Rotate{' XYZ'[number]}", angle)

    # ------------------------------------------------------------------ shapes

    def _do_rect(self, line: Line) -> None:
        name = line.name.title()
        is_flat = name in {"Rect", "Oval", "Arc"} or (name == "Line" and not self.is_3d)
        count = 4 if is_flat else 6
        values = self._need(line, count + 2 * (name == "Arc"))
        self.polygon = None
        given = dict(zip(tables.NAMES, values[:count], strict=False))
        made = self._add(self._into(line.level), name, **given)
        more = values[count:]
        if name == "Arc":
            made.attributes |= {"start": text_of(more[0]), "end": text_of(more[1])}
            more = more[2:]
        if more and name in {"Rect", "Oval"}:
            start, end = (text_of(value) for value in self._need(line, count + 2)[count:])
            made.children.append(Command("arc", {"start": start, "end": end}, line.number))
        elif more and name in {"Line", "Arc"}:
            made.attributes |= {"tolerance": text_of(more[0])} if number_of(more[0]) > 0 else {}
        elif more and name in {"Cylinder", "Torus"}:
            made.attributes["axis"] = str(self._choice(more[0], {"x": 1, "y": 2, "z": 3}, "axis"))
            made.attributes |= {"radius": text_of(more[1])} if len(more) > 1 else {}
        elif more:
            raise ScriptError(f"not supported: the value '{text_of(more[0])[:40]}' of '{name}'")

    _do_oval = _do_arc = _do_line = _do_box = _do_sphere = _do_cylinder = _do_torus = _do_rect

    def _do_polypt(self, line: Line) -> None:
        if not line.values:
            self.polygon = None
            return
        x, y = self._need(line, 2)[:2]
        parent = self._into(line.level)
        if self.polygon is None or parent.children[-1] is not self.polygon:
            self.polygon = self._add(parent, "Polygon")
        self._add(self.polygon, "pt", x=x, y=y)

    # ---------------------------------------------------------------- pictures

    def _do_bmpregion(self, line: Line) -> None:
        name, *size = self._need(line, 1)
        sizes = dict(zip(("width", "height"), size, strict=False))
        self.body = self._add(self.blocks["MaterialPoints"], "BMP", name=name, **sizes)

    def _do_origin(self, line: Line) -> None:
        place = dict(zip(("x", "y", "z", "flipped"), self._need(line, 2), strict=False))
        self._add(self._picture(line), "Origin", **place)

    def _do_intensity(self, line: Line) -> None:
        key, low, high, *pairs = self._need(line, 3)
        if text_of(key) not in self.ids:
            names = ("minAngle", "maxAngle")
            angles = dict(zip(names, pairs, strict=False))
            self._add(self._picture(line), "Intensity", imin=low, imax=high, **angles)
            return
        level = self._add(self._picture(line), "Intensity", imin=low, imax=high, **self._named(text_of(key)))
        speed: dict[str, Scalar] = {}
        for word, value in zip(pairs[::2], pairs[1::2], strict=False):
            name = text_of(word).lower()
            if name in {"vx", "vy", "vz"}:
                speed[name[1]] = value
            elif name in _OF_LEVEL:
                self._add(level, _OF_LEVEL[name], value)
            else:
                raise ScriptError(f"not supported: the property '{name[:40]}' of 'Intensity'")
        if speed:
            self._add(level, "vel", **speed)

    def _picture(self, line: Line) -> Command:
        if self.body is None or self.body.name != "BMP":
            raise ScriptError(f"'{line.text.split(' ')[0]}' belongs into a 'BMPRegion'")
        return self.body
