"""Cracks, their faces, fracture quantities and growth."""

import math
from typing import Any

from mpmcli.importers.nairnmpm.bodies import Bodies
from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.contact import law
from mpmcli.importers.nairnmpm.grammar import FRACTURE
from mpmcli.importers.nairnmpm.job import Job, Material
from mpmcli.importers.nairnmpm.values import Value

Made = dict[str, Any]
_OWN = ("friction", "Dn", "Dnt", "Dnc", "Dt", "law", "lawname")
"""Attributes of a crack that give a law of its own."""
_MOVES = {"cm": "mass", "avg": "average"}
_WHY = ", which the growth of cracks needs"


def cracks(job: Job, root: Command, header: Command, bodies: Bodies) -> None:
    """The sections of cracks and of fracture."""
    lists = list(root.all("CrackList"))
    settings = header.last("Cracks")
    if not lists:
        if settings is not None:
            job.ignored(settings, "there are no cracks in this file")
        return
    faces, moves = None, None
    if settings is not None:
        friction = settings.last("Friction")
        faces = law(job, friction) if friction is not None else None
        plane = settings.last("MovePlane")
        if plane is not None:
            moves = _MOVES.get((plane.get("type") or "avg").lower(), "average")
            if (plane.get("prevent") or "no").lower() == "yes":
                job.note("ignored", plane, "attribute prevent: planes of cracks do not cross here")
        _fracture(job, settings.last("JContour"))
    made = []
    for number, command in enumerate(lists, start=1):
        crack = _crack(job, command, bodies, "crack" if len(lists) == 1 else f"crack_{number}")
        if crack is None:
            continue
        face_law = law(job, command) if any(name in command.attributes for name in _OWN) else faces
        if face_law is not None and face_law["kind"] != "frictionless":
            crack["faces"] = {"law": face_law}
        if moves is not None and moves != "average":
            crack["moves"] = moves
        if (command.get("type") or "free") == "fixed":
            crack["moves"] = "fixed"
        made.append(crack)
    _grow(job, settings, bodies, made)
    if made:
        job.scene["cracks"] = made
    if made and "heat" in job.scene:
        job.note("not_supported", lists[0], "cracks together with conduction or ramps of the temperature")
    if not job.tips and job.scene.pop("fracture", None) is not None:
        words = "no end of a crack has a material as its tip, so that there is no J and no growth"
        job.changed(lists[0], words)


def _fracture(job: Job, contour: Command | None) -> None:
    if contour is None:
        return
    size, terms = round(job.plain(contour, "size", 2.0)), round(job.plain(contour, "terms", 1.0))
    made: Made = {"integral": "contour", "size": max(1, size)}
    if terms == 2:
        made["terms"] = 2
    job.scene["fracture"] = made


def _grow(job: Job, settings: Command | None, bodies: Bodies, made: list[Made]) -> None:
    """Growth of each tip as its material has it."""
    solid = set(map(id, bodies.materials))
    materials = [m for m in job.materials if id(m) in solid and not m.is_rigid]
    for place in [*([settings] if settings is not None else []), *(m.command for m in materials)]:
        job.unsupported(place, "a second criterion of growth", "AltPropagate")
    of_tips = [job.materials[number - 1] for number in dict.fromkeys(job.tips.values())]
    growths = {id(m): _growth(job, settings, m) for m in of_tips or materials[:1]}
    for crack in made:
        for end in ("start", "end"):
            number = job.tips.get(f"{crack['name']}:{end}")
            growth = growths[id(job.materials[number - 1])] if number is not None else None
            if growth is not None:
                crack.setdefault("growth", {})[end] = dict(growth)
                job.scene.setdefault("fracture", {"integral": "contour", "size": 2})
    for material in materials:
        for inside in material.command.all("Propagate"):
            if id(material) not in growths:
                job.ignored(inside, "no tip of a crack has this material")
    _skip_properties(job, materials)


def _growth(job: Job, settings: Command | None, material: Material) -> Made | None:
    """Growth in a material: by its own criterion, or by that of all."""
    length = settings.last("PropagateLength") if settings is not None else None
    of_all = list(settings.all("Propagate")) if settings is not None else []
    own = list(material.command.all("Propagate"))
    of_all, own = ([c for c in each if round(job.plain(c, "criterion")) != 0] for each in (of_all, own))
    chosen = own or of_all
    if not chosen:
        return None
    for default in of_all if own else []:
        job.note("ignored", default, "the criterion of the material counts")
    command = chosen[-1]
    if len(chosen) > 1:
        job.note("not_supported", command, "growth by several criteria")
    if round(job.plain(command, "traction")) > 0:
        job.note("not_supported", command, "traction laws on new faces of cracks")
    criterion = _criterion(job, command, material)
    if criterion is None:
        return None
    made: Made = {"criterion": criterion}
    direction = round(job.plain(command, "direction"))
    if direction == 1:
        made["direction"] = {"kind": "self_similar"}
    elif direction > 1:
        job.note("not_supported", command, f"direction {direction} of growth")
    made["increment"] = (job.number(length, None) if length is not None else None) or 0.5
    return made


def _criterion(job: Job, command: Command, material: Material) -> Made | None:
    code = round(job.plain(command, "criterion"))
    properties = material.command
    if code in {1, 4}:
        K = job.needed(properties, "KIc", "stress_intensity", why=_WHY)
        kind = "maximum_hoop_stress" if code == 1 else "strain_energy_density"
        return None if K is None else {"kind": kind, "K_Ic": K}
    if code == 7:
        J = job.needed(properties, "JIc", "energy_rate", shown=True, why=_WHY)
        return None if J is None else {"kind": "energy_release_rate", "J_c": J}
    if code == 6:
        found = job.properties(properties, {"delIc": "normal", "delIIc": "tangential"})
        found = {name: value for name, value in found.items() if value.number > 0}
        if found:
            return {"kind": "opening", **found}
        job.error(properties, f"the command <delIc> is missing{_WHY}")
        return None
    job.note("not_supported", command, f"criterion {code} of growth")
    return None


def _skip_properties(job: Job, materials: list[Material]) -> None:
    for material in materials:
        for inside in material.command.children:
            if inside.name in FRACTURE.split() and not inside.handled:
                job.ignored(inside, "no criterion of growth uses it")


def _crack(job: Job, command: Command, bodies: Bodies, name: str) -> Made | None:
    points: list[list[Any]] = []
    tips: list[int] = []
    arc: Made | None = None
    for inside in command.children:
        inside.handled = True
        if inside.name == "pt":
            pair: list[Any] = [job.coordinate(inside, letter, axis) for axis, letter in enumerate("xy")]
            _traction(job, inside)
            if None in pair:
                return None
            points.append(pair)
            tips.append(round(job.plain(inside, "tip", -1.0)))
        elif inside.name == "Line":
            _traction(job, inside)
            job.plain(inside, "resolution", 1.0)
            ends = [
                [value for letter in "xy" if (value := job.number(inside, f"{letter}{end}")) is not None]
                for end in ("min", "max")
            ]
            if any(len(pair) < 2 for pair in ends):
                return None
            numbers = [round(job.plain(inside, f"{end}_tip", -1.0)) for end in ("start", "end")]
            joins = bool(points) and all(
                abs(a.scaled - b.scaled) < job.tolerance for a, b in zip(points[-1], ends[0], strict=True)
            )
            points += ends[1:] if joins else ends
            tips += numbers[1:] if joins else numbers
        elif inside.name == "Circle":
            _traction(job, inside)
            arc, numbers = _arc(job, inside)
            tips += numbers
        elif inside.name == "Thickness":
            job.ignored(inside, "the thickness of cracks is that of the analysis")
        else:
            job.unsupported(inside, "no counterpart in a crack")
    if arc is not None and points:
        job.unsupported(command, "a crack of arcs and lines")
        return None
    if arc is None and len(points) < 2:
        job.error(command, "two points are needed at least")
        return None
    made: Made = {"name": name, "path": arc or {"kind": "points", "points": points}}
    mouths = {end: "mouth" for end, tip in (("start", tips[0]), ("end", tips[-1])) if tip == -2}
    for end, tip in (("start", tips[0]), ("end", tips[-1])):
        if tip > len(job.materials):
            job.error(command, f"the tip has material {tip}; the file has {len(job.materials)}")
        elif tip > 0:
            job.tips[f"{name}:{end}"] = tip
    if mouths:
        made["ends"] = mouths
        if arc is None:
            _reach_surface(job, command, points, mouths, bodies)
    return made


def _traction(job: Job, command: Command) -> None:
    """Laws of single segments."""
    if command.get("matname") is not None or job.plain(command, "mat") > 0:
        job.note("not_supported", command, "a traction law of a segment of a crack")


def _arc(job: Job, command: Command) -> tuple[Made | None, list[int]]:
    given = {word: job.number(command, word) for word in ("xmin", "xmax", "ymin", "ymax")}
    ends = {word: 0.0 if value is None else value.scaled for word, value in given.items()}
    job.plain(command, "resolution", 1.0)
    half = [(ends["xmax"] - ends["xmin"]) / 2, (ends["ymax"] - ends["ymin"]) / 2]
    tips = [round(job.plain(command, f"{end}_tip", -1.0)) for end in ("start", "end")]
    angles = [job.plain(command, "start_angle", 0.0), job.plain(command, "end_angle", 360.0)]
    if abs(half[0] - half[1]) > 1e-9 * max(map(abs, half)):
        job.note("not_supported", command, "a crack along an ellipse")
        return None, tips
    center = [(ends["xmin"] + ends["xmax"]) / 2, (ends["ymin"] + ends["ymax"]) / 2]
    return {"kind": "arc", "center": center, "radius": half[0], "from": angles[0], "to": angles[1]}, tips


def _reach_surface(
    job: Job, command: Command, points: list[list[Any]], mouths: dict[str, str], bodies: Bodies
) -> None:
    """Let a mouth that lies less than a cell within a body pass its surface, as a mouth must here."""
    cell = min(job.cell)
    for end in mouths:
        tip, inner = (points[0], points[1]) if end == "start" else (points[-1], points[-2])
        x, y = (float(v.scaled) for v in tip)
        dx, dy = x - inner[0].scaled, y - inner[1].scaled
        length = math.hypot(dx, dy)
        if length == 0:
            continue
        for box in bodies.boxes:
            if box is None or not all(a <= v <= b for v, a, b in zip((x, y), *box, strict=True)):
                continue
            gaps = [
                ((b if d > 0 else a) - v) / d
                for v, d, a, b in zip((x, y), (dx / length, dy / length), *box, strict=True)
                if abs(d) > 1e-9
            ]
            gap = min(gaps)
            if 0 <= gap < cell:
                reach, side = gap + 0.25 * cell, "past the surface"
                if job.analysis == "axisymmetric" and x + reach * dx / length < 0:
                    reach, side = -x * length / dx, "to the axis"
                tip[:] = [Value(x + reach * dx / length), Value(y + reach * dy / length)]
                job.changed(
                    command, f"the {end} of the crack is moved by {reach:g}, {side}, as a mouth must be"
                )
