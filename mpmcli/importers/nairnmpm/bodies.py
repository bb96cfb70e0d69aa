"""MaterialPoints: bodies, holes, pictures and lists of points."""

import math
from io import BytesIO
from pathlib import Path
from typing import Any

from mpmcli.core.files import NoPlainFile, TooLarge, read_plain
from mpmcli.importers.nairnmpm.anisotropic import ANISOTROPIC, body_axes
from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job, Material
from mpmcli.importers.nairnmpm.shapes import NAMES, Box, limits, region
from mpmcli.importers.nairnmpm.values import Value

LAWS = {12, 13, 14, 20, 23, 26, 33, 34, *range(60, 66)}
"""Types of materials that are laws of contact or traction."""
MAX_PICTURE = 50_000_000


class Bodies:
    """The bodies of a scene, made in the order of the source."""

    def __init__(self, job: Job):
        self.job = job
        self.made: list[dict[str, Any]] = []
        self.materials: list[Material] = []
        self.boxes: list[Box | None] = []
        self.holes: list[dict[str, Any]] = []
        self.default: Value = job.scene["analysis"].get("thickness") or Value(1.0)
        """The thickness of bodies that have none of their own."""
        self.thickness: Value | None = None

    def read(self, block: Command) -> None:
        """Make all bodies of the block."""
        idle: list[Command] = []  # holes without a body after them
        for command in block.all("Body", "Hole", "BMP", "PointList"):
            if command.name == "Body":
                self._body(command)
            elif command.name == "Hole":
                holes = [region(self.job, shape) for shape in command.all(*NAMES)]
                self.holes += [hole for hole in holes if hole is not None]
                idle.append(command)
                continue
            elif command.name == "BMP":
                self._picture(command)
            else:
                self._points(command)
            idle.clear()
        for command in idle:
            self.job.note("ignored", command, "a hole is one of the bodies after it, and there is none")
        self._name()

    def _material(self, command: Command) -> Material | None:
        """The material of a body; None after an error."""
        material = self.job.material(command)
        if material is not None and material.kind in LAWS:
            words = f"'{material.title}' is a law of contact or traction; a body needs a material"
            self.job.error(command, words)
            material.command.skip()
            return None
        return material

    def leave_out_idle(self) -> None:
        """Remove bodies without effect."""
        kept = [index for index, material in enumerate(self.materials) if not material.idle]
        for material in self.materials:
            material.used = not material.idle
        for name in ("made", "materials", "boxes"):
            setattr(self, name, [getattr(self, name)[index] for index in kept])

    def _body(self, command: Command) -> None:
        job = self.job
        material = self._material(command)
        regions = []
        late = False
        last = max((i for i, inside in enumerate(command.children) if inside.name in NAMES), default=0)
        turned = command.last("Transform")
        for index, inside in enumerate(command.children):
            if inside.name in NAMES:
                inside.handled = True
                regions.append(region(job, inside))
            elif (inside.name == "Unrotate" and index > last) or inside is turned:
                inside.handled = True
            elif inside.name == "Deform":
                words = "a deformation at the start; bodies may have 'stress: {kind: strain, …}'"
                job.unsupported(inside, words)
            elif regions:
                late = True
        if late:
            job.unsupported(command, "velocities or angles that change between the shapes of a body")
        found = [r for r in regions if r is not None]
        if material is None or not found:
            if not regions:
                job.note("ignored", command, "a body without a shape")
            self._rest(command)
            command.skip()
            return
        whole = found[0] if len(found) == 1 else {"kind": "union", "regions": found}
        body: dict[str, Any] = {"region": whole}
        if turned is not None:
            self._turn(turned, body)
        velocity = self._velocity(command)
        if velocity is not None:
            body["velocity"] = velocity
        if material.is_rigid and command.get("temp") is not None:
            job.note("ignored", command, "attribute temp: rigid bodies have no temperature")
        else:
            self._temperature(command, body, job.number(command, "temp"))
        self._thickness(command, material)
        turns = body_axes(job, command)
        if turns and material.kind in ANISOTROPIC:
            body["axes"] = turns
        elif turns:
            job.note("ignored", command, "angles: the material is isotropic")
        stress = self._stress(command)
        if stress and not material.is_rigid:
            body["stress"] = stress
        elif stress:
            job.note("ignored", command, "rigid bodies have no stress")
        self._rest(command)
        self._add(body, material, command)

    def _turn(self, command: Command, body: dict[str, Any]) -> None:
        """Turn a body about a point, then move it; its particles lie along its sides."""
        job = self.job
        angle = job.plain(command, "angle")
        about = [job.coordinate(command, name, axis) or 0 for axis, name in enumerate(("ox", "oy"))]
        moved = [job.coordinate(command, name, axis) or 0 for axis, name in enumerate(("tx", "ty"))]
        if angle:
            body["region"]["rotate"] = {"angle": angle, "about": about}
            body["particles_along"] = "region"
        if any(isinstance(part, Value) and part.number for part in moved):
            body["region"]["translate"] = moved

    def _velocity(self, command: Command) -> list[Any] | None:
        job = self.job
        parts: list[Any] = []
        for axis, letter in enumerate("xyz"):
            value: Any = job.number(command, f"v{letter}", "velocity")
            for inside in command.all(f"vel0{letter.upper()}"):
                value = job.formula(inside, inside.text, "velocity")
            if axis < len(job.axes):
                parts.append(value if value is not None else 0)
            elif value is not None and not (isinstance(value, Value) and value.number == 0):
                job.note("ignored", command, f"a velocity along {letter}: there is no such axis")
        parts = [0 if isinstance(part, Value) and part.number == 0 else part for part in parts]
        return parts if any(part != 0 for part in parts) else None

    def _temperature(self, command: Command, body: dict[str, Any], value: Value | None) -> None:
        if value is not None and self.job.heats and not value.number > 0:
            words = f"a temperature of {value.number:g}; temperatures are absolute here"
            self.job.note("not_supported", command, words)
        elif value is not None and self.job.heats:
            body["temperature"] = value
        elif value is not None:
            self.job.note("ignored", command, "attribute temp: no temperature changes in this file")

    def _thickness(self, command: Command, material: Material) -> None:
        """All bodies have the thickness of the first one."""
        job = self.job
        value = job.number(command, "thick") or self.default
        if not job.analysis.startswith("plane") or material.is_rigid:
            return
        if self.thickness is not None and abs(value.scaled - self.thickness.scaled) > 1e-12:
            words = f"thickness {value.number:g}, another than that of the bodies before"
            job.note("not_supported", command, words)
        elif value.scaled > 0:
            self.thickness = value
            if value is not self.default:
                job.scene["analysis"]["thickness"] = value

    def _rest(self, command: Command) -> None:
        """Concentrations and rotation."""
        for name in ("conc", "wtconc", "rpm"):
            if self.job.plain(command, name):
                self.job.note("not_supported", command, f"attribute {name}")

    def _stress(self, command: Command) -> dict[str, Any]:
        """Initial stress, as numbers or expressions of place."""
        found: dict[str, Any] = {}
        for axes in ("XX", "YY", "ZZ", "XY", "YZ", "XZ"):
            for inside in command.all(f"ss0{axes}"):
                value = self.job.formula(inside, inside.text)
                if value is not None and value.text.strip() not in {"0", "0.0"}:
                    found[axes.lower()] = value
        return {"kind": "components", **found} if found else {}

    def _add(self, body: dict[str, Any], material: Material, command: Command) -> None:
        if not self._keep_in_grid(body, command):
            return
        material.used = True
        per_axis = self.job.scene.get("_particles_per_axis")
        if per_axis not in {None, 2}:
            body["particles_per_axis"] = per_axis
        d = len(self.job.axes)
        box = limits(body["region"], d)
        if self.holes and body["region"]["kind"] != "points":  # NairnMPM keeps listed points in holes
            subtract = [hole for hole in self.holes if _meet(box, limits(hole, d))]
            if subtract:
                body["region"] = {"kind": "difference", "region": body["region"], "subtract": subtract}
        if any(_meet(box, other) for other in self.boxes):
            body["overlap"] = "keep"
        self.made.append(body)
        self.materials.append(material)
        self.boxes.append(box)

    def _keep_in_grid(self, body: dict[str, Any], command: Command) -> bool:
        """Leave out what lies beyond the grid, where NairnMPM makes no particles; False if nothing is left."""
        job = self.job
        made, box = body["region"], limits(body["region"], len(job.axes))
        if box is None or "particles_along" in body:
            return True
        sides = list(zip(*box, job.lower, job.upper, strict=True))
        if all(low >= a - job.tolerance and high <= b + job.tolerance for low, high, a, b in sides):
            return True
        if any(low >= b or high <= a for low, high, a, b in sides):
            job.note("ignored", command, "the body lies beyond the grid")
            return False
        job.changed(command, "what lies beyond the grid is left out, as in NairnMPM")
        if made["kind"] == "box":
            made["lower"] = [
                Value(a) if low < a else v for v, (low, _, a, _) in zip(made["lower"], sides, strict=True)
            ]
            made["upper"] = [
                Value(b) if high > b else v for v, (_, high, _, b) in zip(made["upper"], sides, strict=True)
            ]
            return True
        grid = {"kind": "box", "lower": list(map(Value, job.lower)), "upper": list(map(Value, job.upper))}
        body["region"] = {"kind": "intersection", "regions": [made, grid]}
        return True

    # --------------------------------------------------------------- pictures

    def _picture(self, command: Command) -> None:
        job = self.job
        name = job.source.plain(command.get("name") or "")
        for attribute in ("angles", "anglesX", "anglesY", "anglesZ"):
            if command.get(attribute) is not None:
                job.note("not_supported", command, f"attribute {attribute}: a picture of angles")
        base: dict[str, Any] = {"kind": "bitmap", "file": Path(name).name}
        if job.analysis == "3d":
            job.unsupported(command, "pictures in 3D")
            return
        origin = command.last("Origin")
        if origin is not None:
            corner = [job.number(origin, letter) or 0 for letter in "xy"]
            base["origin"] = corner
            if (origin.get("flipped") or "").lower() in {"yes", "1"}:
                base["flip"] = "vertical"
        if not self._copy(command, name):
            command.skip()
            return
        self._size(command, base)
        words = "a particle has the level at its centre; in NairnMPM that of most of the pixels under it"
        job.changed(command, words)
        turns = body_axes(job, command)
        for level in command.all("Intensity"):
            if "mat" not in level.attributes and "matname" not in level.attributes:
                job.unsupported(level, "intensities that stand for angles")
                continue
            if level.attributes.get("mat", "").strip() == "0" and "matname" not in level.attributes:
                level.skip()
                continue
            material = self._material(level)
            values = [job.number(level, limit) for limit in ("imin", "imax")]
            body: dict[str, Any] = {"region": {**base, "levels": values}}
            self._level(level, body)
            if turns and material is not None and material.kind in ANISOTROPIC:
                body["axes"] = turns
            if material is not None and None not in values:
                self._thickness(command, material)
                self._add(body, material, level)

    def _size(self, command: Command, base: dict[str, Any]) -> None:
        job = self.job
        given = [job.number(command, word) for word in ("width", "height")]
        count = _pixels(job.made.files[base["file"]])
        if count is None:
            job.error(command, f"{base['file']} is no picture that can be read")
            return
        lengths = [None if value is None else value.scaled for value in given]
        pixel = [
            None if length is None else -length if length < 0 else length / n
            for length, n in zip(lengths, count, strict=True)
        ]
        one = next((edge for edge in pixel if edge), None)
        if one is None:
            job.error(command, "the attribute 'width' or 'height' is missing")
        elif None not in given and all(v is not None and v.number > 0 for v in given):
            base["size"] = given
        else:  # pixels are square where one length is given, and negative lengths are those of pixels
            base["size"] = [Value((edge or one) * n) for edge, n in zip(pixel, count, strict=True)]

    def _level(self, level: Command, body: dict[str, Any]) -> None:
        job = self.job
        for inside in level.all("vel"):
            parts = [job.number(inside, letter, "velocity") or 0 for letter in job.axes]
            if any(isinstance(part, Value) and part.number != 0 for part in parts):
                body["velocity"] = parts
        for inside in level.all("Temperature"):
            self._temperature(inside, body, job.number(inside, None))
        job.unsupported(level, "a value for one intensity", "Thickness Angle Concentration")
        for attribute in ("minAngle", "maxAngle"):
            if level.get(attribute) is not None:
                job.note("not_supported", level, f"attribute {attribute}")

    def _copy(self, command: Command, name: str) -> bool:
        """Take the picture into the files of the translation; False after an error."""
        job = self.job
        folder = job.made.source.resolve().parent
        path = (folder / name).resolve()
        if not path.is_relative_to(folder):
            job.error(command, f"the picture {name} lies outside the folder of the file")
            return False
        try:
            contents = read_plain(path, MAX_PICTURE)
        except (OSError, NoPlainFile, TooLarge, ValueError):
            job.error(command, f"the picture {name} cannot be read")
            return False
        job.made.files[Path(name).name] = contents
        return True

    # ----------------------------------------------------------------- points

    def _points(self, command: Command) -> None:
        job = self.job
        groups: dict[tuple[int, tuple[float, ...], float], list[list[float]]] = {}
        for point in command.all("mp"):
            material = self._material(point)
            at, velocity = point.last("pt"), point.last("vel")
            angle = job.plain(point, "angle")
            for name in ("conc", "wtconc", "temp"):
                if job.plain(point, name):
                    job.note("not_supported", point, f"attribute {name} of single points")
            if at is None or material is None:
                if at is None:
                    job.error(point, "the command <pt> is missing")
                continue
            self._thickness(point, material)
            place = [job.number(at, letter) for letter in job.axes]
            speed = [job.number(velocity, letter, "velocity") if velocity else None for letter in job.axes]
            if None in place:
                continue
            sizes = [job.plain(point, f"lp{letter}", 0.5) * job.cell[a] for a, letter in enumerate(job.axes)]
            turned = angle if material.kind in ANISOTROPIC else 0.0
            key = (job.materials.index(material), tuple(v.scaled if v else 0.0 for v in speed), turned)
            row = [v.scaled for v in place if v is not None] + [math.prod(sizes)]
            groups.setdefault(key, []).append(row)
        for number, ((index, speed_of, turned), rows) in enumerate(groups.items(), start=1):
            file = f"points_{number}.csv"
            lines = [",".join((*job.axes, "volume"))]
            lines += [",".join(f"{value:.12g}" for value in row) for row in rows]
            job.made.files[file] = "\n".join(lines) + "\n"
            body: dict[str, Any] = {"region": {"kind": "points", "file": file}}
            if any(speed_of):
                body["velocity"] = list(speed_of)
            if turned:
                body["axes"] = -turned
            self._add(body, job.materials[index], command)

    # ------------------------------------------------------------------ names

    def _name(self) -> None:
        """Name bodies by their materials and, where several have one, by their places."""
        keys = [material.key for material in self.materials]
        endings = {
            key: iter(_places([box for other, box in zip(keys, self.boxes, strict=True) if other == key]))
            for key in keys
        }
        self.made = [
            {"name": key + next(endings[key]), "material": key, **body}
            for key, body in zip(keys, self.made, strict=True)
        ]


def _meet(one: Box | None, other: Box | None) -> bool:
    """Whether two boxes have more than a border in common."""
    if one is None or other is None:
        return True
    pairs = zip(*one, *other, strict=True)
    return all(max(a, c) < min(b, d) - 1e-9 * (abs(b) + abs(d)) for a, b, c, d in pairs)


def _places(boxes: list[Box | None]) -> list[str]:
    """Ends of the names of bodies: left, right, lower, upper, front, back; or numbers."""
    if len(boxes) == 1:
        return [""]
    words = (("_left", "_right"), ("_lower", "_upper"), ("_back", "_front"))
    if len(boxes) == 2 and None not in boxes:
        centers = [[0.5 * (a + b) for a, b in zip(*box, strict=True)] for box in boxes if box is not None]
        gaps = [b - a for a, b in zip(*centers, strict=True)]
        axis = max(range(len(gaps)), key=lambda a: abs(gaps[a]))
        if abs(gaps[axis]) > 0:
            pair = words[axis]
            return list(pair) if gaps[axis] > 0 else [pair[1], pair[0]]
    return [f"_{number}" for number in range(1, len(boxes) + 1)]


def _pixels(contents: str | bytes) -> tuple[int, int] | None:
    """Columns and rows of a picture, or None if it is none."""
    from PIL import Image

    try:
        with Image.open(BytesIO(contents if isinstance(contents, bytes) else contents.encode())) as picture:
            return picture.size
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None
