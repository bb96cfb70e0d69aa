"""GridBCs, ParticleBCs and Gravity as conditions and loads."""

import math
import re
from typing import Any

from mpmcli.importers.base import free_name
from mpmcli.importers.nairnmpm.bodies import Bodies
from mpmcli.importers.nairnmpm.commands import CLOSE, OPEN, Command
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.places import Where, where
from mpmcli.importers.nairnmpm.shapes import NAMES, limits
from mpmcli.importers.nairnmpm.values import Formula, Value

Made = dict[str, Any]
_PLACES = ("BCLine", "BCArc", "BCBox", "BCShape", "LdRect")
_DIRECTIONS = {1: (0,), 2: (1,), 3: (2,), 12: (0, 1), 13: (0, 2), 23: (1, 2), 123: (0, 1, 2)}
"""Axes of a direction of velocity conditions."""
_FACES = {1: ("y", "lower"), 2: ("x", "upper"), 3: ("y", "upper")}
_FACES |= {4: ("x", "lower"), 5: ("z", "lower"), 6: ("z", "upper")}


def raw(value: Value) -> str:
    """A number of the source within an expression, by its name if it has one."""
    if value.name is not None:
        text = f"{OPEN}{value.name}{CLOSE}"
        return f"(-{text})" if value.sign < 0 else text
    return f"{value.number:.12g}"


def history(job: Job, command: Command, value: Value | None, quantity: str, is_alone: bool = True) -> Any:
    """A value by its style: constant, linear in time, sine, cosine, function; None after an error or a note.

    Unless ``is_alone``, it is 0 before it begins, because other values are added to it.
    """
    style, when, function = job.check_style(command)
    later = when is not None and when.number > 0 and style in {1, 2, 6}
    time = "t"  # since the value begins, perhaps before the run
    if when is not None and when.number != 0:
        time = f"(t + {raw(when.negative)})" if when.number < 0 else f"(t - {raw(when)})"
    factor = job.unit(quantity).factor
    amount = value if value is not None else Value(0.0, job.unit(quantity))
    start = raw(when) if when is not None else "0"
    if style == 1:
        return Formula(f"{raw(amount)}*(t >= {start})", factor) if later and not is_alone else amount
    if style == 2:
        past = time if is_alone or not later else f"max(0, {time[1:-1]})"
        return Formula(f"{raw(amount)}*{past}", factor)
    if style in {3, 4}:
        return Formula(f"{raw(amount)}*{'sin' if style == 3 else 'cos'}({start}*t)", factor)
    if style == 6:
        if not (function or "").strip():
            job.error(command, "the attribute 'function' is missing")
            return None
        made = job.formula(command, str(function), quantity, time)
        if made is not None and later:
            return Formula(f"({made.text})*(t >= {start})", factor)
        return made
    job.note("not_supported", command, "silent conditions" if style == 5 else f"style {style}")
    return None


def _window(job: Job, command: Command) -> Made:
    """The time from which a value acts that is alone; functions are 0 before they begin and act from the start."""
    style, when, _ = job.check_style(command)
    return {"from": when} if when is not None and when.number > 0 and style in {1, 2} else {}


def grid_conditions(job: Job, block: Command) -> list[Made]:
    """Conditions on nodes."""
    made: list[Made] = []
    names: set[str] = set()
    for number, shape in enumerate(block.all(*_PLACES), start=1):
        place = where(job, shape, number)
        on = place.nodes(job) if place is not None else None
        if place is not None and on is None and not job.made.errors:
            job.ignored(shape, "it has no node of the grid")
            continue
        for condition in shape.children:
            if condition.name in NAMES:
                continue
            condition.handled = True
            entry = _condition(job, condition)
            if entry is not None and place is not None and on is not None:
                several = sum(child.name in {"DisBC", "TempBC"} for child in shape.children) > 1
                along = entry.get("direction", "temperature")
                end = f"_{along if isinstance(along, str) else 'oblique'}" if several else ""
                first = {"name": _name(f"{place.name}{end}", names), "kind": entry["kind"], "on": on}
                rest = {key: value for key, value in entry.items() if key != "kind"}
                entry.clear()  # reactions know this one
                entry |= first | rest
                made.append(entry)
    return made


def _condition(job: Job, command: Command) -> Made | None:
    if command.name == "DisBC":
        code = round(job.plain(command, "dir"))
        angles = [job.plain(command, name) for name in ("angle", "angle2")]
        number = round(job.plain(command, "id"))
        command.get("value")
        velocity = job.amount(command, "vel disp", "velocity")
        if code not in _DIRECTIONS or any(axis >= len(job.axes) for axis in _DIRECTIONS[code]):
            job.error(command, f"there is no direction {code} in this analysis")
            return None
        value = history(job, command, velocity, "velocity")
        if value is None:
            return None
        direction = _direction(job, code, *angles)
        made = {"kind": "velocity", "direction": direction, "value": value, **_window(job, command)}
        job.conditions.append((number, made))
        return made
    if command.name == "TempBC":
        value = history(job, command, job.number(command, "value"), "temperature")
        style, when, _ = job.check_style(command)
        if style == 6 and when is not None and when.number > 0:
            job.note("not_supported", command, "a temperature that is 0 until its function begins")
            return None
        return None if value is None else {"kind": "temperature", "value": value, **_window(job, command)}
    job.unsupported(command, "no counterpart on nodes")
    return None


def _direction(job: Job, code: int, angle: float, around: float) -> Any:
    """The axis of a direction, or a vector: turned clockwise from the first of two axes, by polar angles from three."""
    axes = _DIRECTIONS[code]
    a, b = math.radians(angle), math.radians(around)
    parts: tuple[float, ...] = (1.0,)
    if len(axes) == 2:
        parts = math.cos(a), -math.sin(a)
    elif len(axes) == 3:
        parts = math.cos(b) * math.sin(a), math.sin(b) * math.sin(a), math.cos(a)
    vector = [0.0] * len(job.axes)
    for axis, part in zip(axes, parts, strict=True):
        vector[axis] = part if abs(part) > 1e-12 else 0.0
    along = [axis for axis, part in enumerate(vector) if part]
    if len(along) == 1 and vector[along[0]] > 0.0:
        return job.axes[along[0]]
    return [Value(part) for part in vector]


def particle_loads(job: Job, block: Command, bodies: Bodies) -> list[Made]:
    """Loads on particles."""
    made: list[Made] = []
    names: set[str] = set()
    for number, shape in enumerate(block.all(*_PLACES), start=1):
        place = where(job, shape, number)
        net = False
        forces: list[list[Any]] = [[] for _ in job.axes]
        for load in shape.children:
            if load.name in NAMES:
                continue
            load.handled = True
            if load.name in {"net", "perParticle"}:
                net = load.name == "net"
            elif load.name in {"LoadBC", "TractionBC"} and job.plain(load, "style") == 5:
                for entry in _silent(job, load, place, bodies):
                    made.append({"name": _name(f"absorbing_{entry['on']['body']}", names), **entry})
            elif load.name == "LoadBC":
                _force(job, load, forces, net)
            elif load.name in {"TractionBC", "HeatFluxBC"}:
                for entry in _on_faces(job, load, place, bodies):
                    name = _name(f"{entry['kind']}_{entry['on']['body']}", names)
                    made.append({"name": name, **entry})
            else:
                job.unsupported(load, "no counterpart on particles")
        if any(forces) and place is not None:
            entry = {
                "name": _name(f"load_{number}", names),
                "kind": "particle_force",
                "on": place.particles(),
            }
            entry["force"] = [_sum(parts) for parts in forces]
            made.append(entry if net else entry | {"per": "particle"})
    return made


def _force(job: Job, load: Command, forces: list[list[Any]], net: bool) -> None:
    axis = round(job.plain(load, "dir")) - 1
    load.get("stress")
    value = job.amount(load, "load value")
    if not 0 <= axis < len(job.axes):
        job.error(load, f"there is no direction {axis + 1} in this analysis")
        return
    found = history(job, load, value, "", is_alone=False)
    if found is None:
        return
    if net and isinstance(found, Formula) and re.search(r"\b[xyz]\b", found.text):
        job.note("not_supported", load, "a net force on particles that depends on their places")
        return
    if job.analysis == "axisymmetric":
        text = found.text if isinstance(found, Formula) else raw(found)
        found = Formula(f"2*pi*{text}" if re.fullmatch(rf"[\w.{OPEN}{CLOSE}]+", text) else f"2*pi*({text})")
        job.changed(load, "forces are those on the full ring; NairnMPM's are per radian")
    forces[axis].append(found)


def _sum(parts: list[Any]) -> Any:
    """One expression for several forces along one axis."""
    if not parts:
        return 0
    if len(parts) == 1:
        return parts[0]
    texts = [part.text if isinstance(part, Formula) else raw(part) for part in parts]
    return Formula(re.sub(rf" \+ \(-({OPEN}\w+{CLOSE})\)\*", r" - \1*", " + ".join(texts)))


def _on_faces(job: Job, load: Command, place: Where | None, bodies: Bodies) -> list[Made]:
    code, face = round(job.plain(load, "dir")), round(job.plain(load, "face", 1.0))
    heat = load.name == "HeatFluxBC"
    quantity = "flux" if heat else ""
    value = history(job, load, job.amount(load, "stress load value", quantity), quantity)
    if value is None or place is None:
        return []
    side = _FACES.get(face)
    directions = {1} if heat else {11, *range(1, len(job.axes) + 1)}
    if side is None or side[0] not in "xyz"[: len(job.axes)] or code not in directions:
        job.note("not_supported", load, f"direction {code} on face {face} of particles")
        return []
    found = _whole_faces(job, place, bodies, side)
    if not found:
        job.note("not_supported", load, "faces of particles that are not whole faces of rectangular bodies")
        return []
    kind, amount = "traction", {"traction": [value if a == code - 1 else 0 for a in range(len(job.axes))]}
    if heat:
        kind, amount = "heat_flux", {"flux": value}
    elif code == 11:
        amount = {"pressure": value.negative}
    if not heat and (code == 11) != ("cpdi" in job.shape):
        dead = "acts on the initial area and NairnMPM's on the present one; see follower"
        follows = "follows the face; NairnMPM's acts on its initial area"
        job.changed(load, follows if code == 11 else dead)
    window = _window(job, load)
    return [{"kind": kind, "on": _face(body, side), **amount, **window} for body in found]


def _face(body: str, side: tuple[str, str]) -> Made:
    return {"body": body, "face": {"axis": side[0], "side": side[1]}}


def _silent(job: Job, load: Command, place: Where | None, bodies: Bodies) -> list[Made]:
    """Dashpots with the impedance of the material, on the face across a direction."""
    axis = round(job.plain(load, "dir")) - 1
    load.skip()
    if load.name == "TractionBC" or not 0 <= axis < 2 or job.analysis == "3d" or place is None:
        job.note("not_supported", load, "silent conditions except <LoadBC> in 2D")
        return []
    sides = [("xy"[axis], side) for side in ("lower", "upper")]
    found = [(side, body) for side in sides for body in _whole_faces(job, place, bodies, side)]
    if not found:
        job.note("not_supported", load, "silent particles that are not whole faces of rectangular bodies")
    return [{"kind": "absorbing", "on": _face(body, side)} for side, body in found]


def _whole_faces(job: Job, place: Where, bodies: Bodies, side: tuple[str, str]) -> list[str]:
    """The rectangular bodies of whose particles a box holds the outermost layer at a side, all of it and no others.

    Empty if it holds particles of bodies in any other way.
    """
    if place.region is not None:
        return []
    axis, upper = "xyz".index(side[0]), side[1] == "upper"
    low, high = [v - job.tolerance for v in place.lower], [v + job.tolerance for v in place.upper]
    per_axis = job.scene.get("_particles_per_axis") or 2
    spacing = [cell / per_axis for cell in job.cell]
    found = []
    for body, box in zip(bodies.made, bodies.boxes, strict=True):
        if box is None:
            return []
        first, last = (
            [end + s * 0.5 * step for end, step in zip(ends, spacing, strict=True)]
            for ends, s in zip(box, (1, -1), strict=True)
        )
        axes = range(len(job.axes))
        if any(high[a] < first[a] or low[a] > last[a] for a in axes):
            continue
        edge = last[axis] if upper else first[axis]
        inner = edge - spacing[axis] if upper else edge + spacing[axis]
        outermost = low[axis] <= edge <= high[axis] and not low[axis] <= inner <= high[axis]
        across = all(low[a] <= first[a] and last[a] <= high[a] for a in axes if a != axis)
        reach = 0.5 * spacing[axis] + job.tolerance
        if not (outermost and across and _is_box_at(body["region"], axis, edge, reach)):
            return []
        found.append(str(body["name"]))
    return found


def _is_box_at(region: Made, axis: int, edge: float, reach: float) -> bool:
    """Whether a region is a box with no hole as near as ``reach`` to the plane at ``edge`` across an axis."""
    box = region["region"] if region["kind"] == "difference" else region
    if box["kind"] != "box":
        return False
    ends = [limits(hole, len(box["lower"])) for hole in region.get("subtract", ())]
    return all(end is not None and not end[0][axis] - reach <= edge <= end[1][axis] + reach for end in ends)


def gravity(job: Job, block: Command) -> list[Made]:
    """Gravity, and body forces that depend on place and time."""
    made: list[Made] = []
    parts: list[Any] = [0] * len(job.axes)
    fields: list[Any] = [0] * len(job.axes)
    for axis, letter in enumerate("XYZ"):
        for inside in block.all(f"Body{letter}Force"):
            value = job.number(inside, None, "acceleration")
            if value is not None and axis < len(job.axes):
                parts[axis] = value if value.number else 0
            elif value is not None and value.number:
                job.ignored(inside, f"there is no axis {letter.lower()}")
        for inside in block.all(f"GridBody{letter}Force"):
            formula = job.formula(inside, inside.text, "acceleration")
            if formula is not None and axis < len(job.axes):
                fields[axis] = formula
            elif formula is not None:
                job.ignored(inside, f"there is no axis {letter.lower()}")
    if any(part != 0 for part in parts):
        made.append({"name": "weight", "kind": "gravity", "acceleration": parts})
    if any(part != 0 for part in fields):
        made.append({"name": "body_force", "kind": "body_force", "acceleration": fields})
    return made


def _name(base: str, taken: set[str]) -> str:
    name = free_name(base, taken)
    taken.add(name)
    return name
