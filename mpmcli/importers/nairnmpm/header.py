"""Header and MPMHeader: analysis, units, method, time, archives; and the grid."""

from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.places import SIDES
from mpmcli.importers.nairnmpm.values import Value, scaled
from mpmcli.materials import MATERIALS
from mpmcli.scene.context import Context
from mpmcli.scene.units import Units

ANALYSES = {10: "plane_strain", 11: "plane_stress", 12: "3d", 13: "axisymmetric"}
_SHAPES = {
    **dict.fromkeys(("Dirac", "Classic", "0"), "linear"),
    **dict.fromkeys(("uGIMP", "GIMP", "1", "Finite"), "ugimp"),
    **dict.fromkeys(("lCPDI", "CPDI", "2"), "lcpdi"),
    **dict.fromkeys(("qCPDI", "3"), "qcpdi"),
    "4": "ugimp",
    **dict.fromkeys(("B2GIMP", "5"), "b2gimp"),
    **dict.fromkeys(("B2SPLINE", "6"), "bspline2"),
    **dict.fromkeys(("B2CPDI", "7"), "b2cpdi"),
}
_UPDATES = {0: "usf", 2: "usavg", 3: "usl"}


def header(job: Job, command: Command) -> None:
    """Title, kind of analysis and units."""
    units: dict[str, str] | None = {"length": "mm", "mass": "g", "time": "ms"}
    for inside in command.all("Analysis"):
        code = round(job.plain(inside, None))
        if code in ANALYSES:
            job.analysis = ANALYSES[code]
        else:
            words = "NairnMPM's are 10 to 13 (plane strain, plane stress, 3D, axisymmetric)"
            job.unsupported(inside, f"analysis {code}; {words}")
    for inside in command.all("ConsistentUnits"):
        job.legacy = False
        replaced = {"sec": "s", "msec": "ms", "microns": "um"}
        named = {name: inside.get(name) or "" for name in ("length", "mass", "time")}
        is_named = all(named.values()) and not set(named.values()) & set("LMT")
        units = {name: replaced.get(word, word) for name, word in named.items()} if is_named else None
    job.unsupported(command, "a switch of developers", "DevelFlag")
    description = command.last("Description")
    lines = [line.strip() for line in description.text.splitlines() if line.strip()] if description else []
    labels = {line.split(":", 1)[0].lower(): line.split(":", 1)[1].strip() for line in lines if ":" in line}
    title = labels.get("problem") or labels.get("title") or (lines[0] if lines else "")
    if title:
        job.scene["title"] = job.source.plain(title)[:200]
        rest = [line for line in lines if line != title and not line.endswith(f": {title}")]
        if rest:
            job.made.comment(["title"], job.source.plain(" / ".join(rest))[:1000])
    if units is not None:
        job.scene["units"] = units
        if job.legacy:
            job.made.comment(["units"], "forces N, stresses MPa, energies mJ, speeds m/s")
    job.scene["analysis"] = {"kind": job.analysis}


def grid(job: Job, mesh: Command) -> list[dict[str, Any]]:
    """The grid; returns its symmetry planes as conditions."""
    job.unsupported(mesh, "a mesh of listed elements; only regular grids are", "NodeList ElementList")
    found = mesh.last("Grid")
    if found is None:
        job.error(mesh, "the command <Grid> is missing")
        return []
    rows: list[tuple[Value, Value, Value]] = []
    symmetries: list[dict[str, Any]] = []
    for axis, letter in enumerate(job.axes):
        low, high = (job.number(found, f"{letter}{side}") for side in ("min", "max"))
        word = ("Horiz", "Vert", "Depth")[axis]
        along = found.last(word)
        if along is None or low is None or high is None:
            if along is None:
                job.error(found, f"the command <{word}> is missing")
            return []
        if low.scaled > high.scaled:
            low, high = high, low
        row = _axis(job, along, "xyz"[axis], low, high)
        if row is None:
            return []
        low, high, cell = row
        if job.analysis == "axisymmetric" and axis == 0 and low.scaled < 0 < high.scaled:
            if abs(low.scaled / cell.scaled - round(low.scaled / cell.scaled)) > 1e-6:
                job.error(found, "r = 0 is not at a line of the grid")
                return []
            job.changed(found, "the grid begins at r = 0")
            low = Value(0.0)
        rows.append((low, high, cell))
        for side, attribute in (("lower", "symmin"), ("upper", "symmax")):
            at = job.number(along, attribute)
            if at is not None:
                plane: dict[str, Any] = {"axis": letter, "at": at}
                middle = 0.5 * (low.scaled + high.scaled)
                if (at.scaled < middle) != (side == "lower") or at.scaled == middle:
                    plane["side"] = side
                name = f"symmetry_{SIDES[axis, side == 'upper']}"
                symmetries.append({"name": name, "kind": "symmetry", "plane": plane})
    if len(job.axes) == 2:
        found.get("zmin")
        found.get("zmax")
        for inside in found.all("Depth"):
            job.error(inside, "belongs to analyses in 3D")
    lower, upper, cells = map(list, zip(*rows, strict=True))
    job.lower, job.upper, job.cell = ([v.scaled for v in values] for values in (lower, upper, cells))
    same = all(abs(size - job.cell[0]) <= 1e-9 * job.cell[0] for size in job.cell)
    job.scene["grid"] = {"lower": lower, "upper": upper, "cell": cells[0] if same else cells}
    thickness = job.number(found, "thickness")
    if thickness is not None and job.analysis.startswith("plane"):
        job.scene["analysis"]["thickness"] = thickness
    return symmetries


def _axis(
    job: Job, along: Command, letter: str, low: Value, high: Value
) -> tuple[Value, Value, Value] | None:
    """Limits and cell along one axis, or None after an error."""
    ratio = job.plain(along, f"r{letter}", 1.0)
    if ratio != 1.0:
        job.unsupported(along, f"cells whose size changes by the ratio {ratio:g}; only regular grids are")
        return None
    length = high.scaled - low.scaled
    cell = job.number(along, "cellsize")
    count = round(job.plain(along, f"n{letter}"))
    if not length > 0:
        job.error(along, f"the grid has no extent along {letter}")
        return None
    if cell is not None and cell.scaled > 0:
        cells = length / cell.scaled
        if cells > 1e6:
            job.error(along, f"more than a million cells along {letter}")
            return None
        if abs(cells - round(cells)) > 1e-6:
            whole = int(cells) + 1
            high = Value(low.scaled + whole * cell.scaled)
            job.changed(along, f"{letter} ends at {high.scaled:g}, after whole cells, as in NairnMPM")
        return low, high, cell
    if count < 1:
        job.error(along, f"a positive cellsize or n{letter} is missing")
        return None
    return low, high, Value(length / count)


def method(job: Job, command: Command) -> None:
    """Shape functions, update of strains, transfer and damping."""
    made: dict[str, Any] = {}
    shape = command.last("GIMP")
    if shape is not None:
        word = shape.get("type") or "uGIMP"
        if word in _SHAPES:
            job.shape = _SHAPES[word]
            if word in {"Finite", "4"}:
                job.changed(shape, "domains of particles keep their size; lcpdi deforms them")
        else:
            job.unsupported(shape, f"type '{word}'")
    made["shape"] = job.shape
    code = job.code(command, "MPMMethod", 2)
    if (update := command.last("MPMMethod")) is not None and code not in _UPDATES:
        job.unsupported(update, f"method {code}; 0, 2 and 3 are USF, USAVG and USL")
    skips = command.last("SkipPostExtrapolation") is not None
    word = _UPDATES.get(code, "usavg")
    made["update"] = word if skips or word == "usf" else f"{word}+"
    made["transfer"] = {"kind": "flip"}
    job.scene["method"] = made
    job.made.comment(["method", "transfer"], "NairnMPM's default")
    _damping(job, command, made)
    for inside in command.all("XPIC"):
        order = round(job.plain(inside, "order", 2.0))
        made["transfer"] = {"kind": "xpic", "order": max(1, order)}
    for inside in command.all("FractionFLIP"):
        share = job.plain(inside, None)
        if share == 0.0:
            made["transfer"] = {"kind": "xpic", "order": 1}
            job.made.comments.pop(("method", "transfer"), None)
        elif share != 1.0:
            words = "of FLIP mixed with PIC; XPIC or FMPM of order 2 filter noise instead"
            job.unsupported(inside, f"{share:g} {words}")
    if (points := command.last("MatlPtsPerElement")) is not None:
        count = round(job.plain(points, None))
        per_axis = round(max(count, 1) ** (1 / len(job.axes)))
        if per_axis ** len(job.axes) == count and 1 <= per_axis <= 100:
            job.scene["_particles_per_axis"] = per_axis
        else:
            job.unsupported(points, f"{count} particles per cell, not the same number along each axis")


def _damping(job: Job, command: Command, made: dict[str, Any]) -> None:
    found: dict[str, Any] = {}
    for name, key in (("Damping", "grid"), ("PDamping", "particle")):
        for inside in command.all(name):
            function = inside.get("function")
            if inside.get("PIC") is not None and job.plain(inside, "PIC") != 0:
                job.unsupported(inside, "PIC damping; use the transfer xpic")
            elif function is not None:
                found[key] = job.formula(inside, function, "frequency")
            else:
                rate = job.number(inside, None, "frequency")
                if rate is not None and rate.number < 0:
                    job.unsupported(inside, "a negative damping")
                elif rate is not None and rate.number != 0:
                    found[key] = rate
    for inside in command.all("FeedbackDamping", "PFeedbackDamping"):
        gain = job.number(inside, None)
        if gain is None or gain.number == 0:
            job.ignored(inside, "its gain is 0")
            continue
        found["feedback"] = _feedback(job, inside, gain)
    found = {key: value for key, value in found.items() if value is not None}
    if found:
        made["damping"] = found


def _feedback(job: Job, command: Command, gain: Value) -> dict[str, Any]:
    """Damping towards a kinetic energy."""
    made: dict[str, Any] = {"damps": "particle"} if command.name == "PFeedbackDamping" else {}
    target = command.get("target")
    made |= {"gain": gain, "target": target and job.formula(command, target, "kinetic")}
    made["limit"] = job.number(command, "max", "frequency")
    return {key: value for key, value in made.items() if value is not None}


def time(job: Job, command: Command) -> None:
    """End and time step."""
    end, step, cfl = None, None, None
    where = command
    for inside in command.all("Timing"):
        end = job.number(inside, "max", "time") or end
        step = job.number(inside, "step", "time") or step
        cfl = job.number(inside, "CFL") or cfl
        if inside.get("TransCFL") is not None:
            words = "attribute TransCFL: steps of conduction follow their own stability limit"
            job.note("ignored", inside, words)
        where = inside
    end = job.property(command, "MaxTime", "time") or end
    for inside in command.all("TimeStep"):
        step = job.number(inside, None, "time") or step
        where = inside
    cfl = job.property(command, "TimeFactor") or cfl
    made: dict[str, Any] = {"end": end if end is not None else Value(1.0, job.unit("time"))}
    if not made["end"].scaled > 0:
        job.made.error(command.line, "<MaxTime>", "the end must be above 0")
    made["courant"] = cfl if cfl is not None else 0.5
    if cfl is None:
        job.made.comment(["time"], "0.5 is NairnMPM's default")
    if step is not None:
        speed = _wave_speed(job)
        courant = cfl.number if cfl is not None else 0.5
        limit = courant * min(job.cell) / speed if speed > 0 and job.cell else made["end"].scaled
        if 0 < step.scaled < limit:
            made = {"end": made["end"], "step": step}
            job.made.comments.pop(("time",), None)
        else:
            job.note("ignored", where, "the step of the Courant number is smaller")
    job.scene["time"] = made


def _wave_speed(job: Job) -> float:
    """The largest wave speed of the materials, in the scene's units; 0 if none has one."""
    context = Context(Units(), {})
    analysis = "plane_strain" if job.analysis == "plane_stress" else job.analysis
    speeds = [0.0]
    for made in job.scene["materials"].values():
        try:
            model: Any = MATERIALS[made["kind"]].model_validate(scaled(made), context=context)
        except ValueError:
            continue  # said by the check of the scene
        speeds.append(model.initial_wave_speed(analysis))
    return max(speeds)


def display(job: Job, command: Command) -> None:
    """What is archived of cracks without cracks, and what happens to particles that leave."""
    if not job.scene.get("cracks"):
        job.ignored(command, "there are no cracks in this file", "CrackArchiveOrder")
    for inside in command.all("LeaveLimit"):
        count = round(job.plain(inside, None))
        if abs(count) > 1:
            job.scene["domain"] = {"on_exit": "delete"}
            words = "" if count < 0 else ", which newer versions of NairnMPM push back"
            job.changed(inside, f"particles that leave are deleted, however many{words}")
    for inside in command.all("DeleteLimit"):
        if job.plain(inside, None) > 1:
            job.changed(inside, "a particle whose state is no number ends the run")
