"""What is archived, custom tasks, and heat."""

import re
from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.ramps import RAMPS, ramp_commands
from mpmcli.importers.nairnmpm.values import Value

_FIELDS = {2: "velocity", 3: "stress", 4: "deformation_gradient", 8: "temperature"}
"""Fields by their place in the text of MPMArchiveOrder."""
_RESULTS = {
    **{name: name for name in ("velocity", "stress", "temperature", "pressure")},
    **dict.fromkeys(("strain", "plasticstrain", "rotstrain"), "deformation_gradient"),
    **{"workenergy": "stress_work", "strainenergy": "strain_energy"},
}
_GLOBALS = {
    "kinetic energy": "kinetic_energy",
    "grid kinetic energy": "kinetic_energy",
    "strain energy": "strain_energy",
    "work energy": "stress_work",
    "potential energy": "strain_energy",
    "plastic energy": "plastic_work",
    "heat energy": "heat_inflow",
    "thermal energy": "thermal_energy",
    "interface energy": "interface_energy",
    "friction work": "contact_work",
    "external work": "external_work",
}
_OF_MATERIAL = {
    "s": "stress_",
    "e": "strain_",
    "vel": "velocity_",
    "disp": "displacement_",
    "temp": "temperature",
}
_TENSOR = {"xx", "yy", "zz", "xy", "xz", "yz"}


def archive(job: Job, header: Command, names: list[tuple[str, str]]) -> None:
    """The section of archives. ``names`` are the bodies and their materials."""
    made: dict[str, Any] = {}
    groups = list(header.all("ArchiveGroup"))
    every = job.property(header, "ArchiveTime", "time")
    for inside in groups:
        every = every or job.number(inside, "time", "time")
        if job.plain(inside, "start"):
            job.changed(inside, "archives begin at time 0")
        inside.get("start")
    if len(groups) > 1:
        job.changed(groups[1], "archives are written at the interval of the first group")
    fields = _fields(job, header)
    if every is not None and every.scaled > 0:
        made["particles"] = {"every": every, "fields": fields}
    wide = job.property(header, "GlobalArchiveTime", "time")
    columns = _tips(job, header)
    if job.scene.get("cracks") and every is not None:
        made["cracks"] = {"every": every}
    for inside in header.all("GlobalArchive"):
        column = column_of(job, inside, names)
        if column is not None and column not in columns:
            columns.append(column)
    if columns and wide is None:
        wide = every
    if wide is not None and wide.scaled > 0:
        made["globals"] = {"every": wide}
        if columns:
            made["globals"]["columns"] = columns
    job.scene["archive"] = made


def _tips(job: Job, header: Command) -> list[str]:
    """Columns of J and K of tips, which NairnMPM archives with its cracks."""
    text = job.word(header.last("CrackArchiveOrder"))
    results = {
        (inside.attributes.get("result") or "").lower()
        for inside in header.children
        if inside.name == "MPMArchive"
    }
    quantities = ["J"] if text[2:3] == "Y" or "jintegral" in results else []
    quantities += ["K_I", "K_II"] if text[3:4] == "Y" or "stressintensity" in results else []
    if quantities and job.tips:
        job.scene.setdefault("fracture", {"integral": "contour", "size": 2})
    return [f"{quantity}[{tip}]" for quantity in quantities for tip in job.tips]


def _fields(job: Job, header: Command) -> list[str]:
    found = ["displacement"]
    text = job.word(header.last("MPMArchiveOrder"))
    found += [name for place, name in _FIELDS.items() if text[place : place + 1] == "Y"]
    for inside in header.all("MPMArchive"):
        result = (inside.get("result") or "").lower()
        if result in {"jintegral", "stressintensity"}:
            continue
        if result in _RESULTS:
            found.append(_RESULTS[result])
        else:
            job.note("ignored", inside, f"the result {result} is not archived")
    if len(found) == 1:
        found += ["velocity", "stress", "deformation_gradient"]
    fields = list(dict.fromkeys(found))
    return [name for name in fields if name != "temperature" or job.heats]


_CYLINDRICAL = re.compile(r"(s|e|vel|disp|contact|reaction)([RZT]{1,2})([ep]?)\Z")


def _cartesian(kind: str) -> str:
    """A quantity along R, Z and T, in capitals, by the axes x, y and z that stand for them: sZZ is syy, not szz."""
    found = _CYLINDRICAL.match(kind)
    if found is None:
        return kind
    return found[1] + found[2].translate(str.maketrans("RZT", "xyz")) + found[3]


def column_of(job: Job, command: Command, names: list[tuple[str, str]]) -> str | None:
    """The column of a command with ``type`` and perhaps a material, or None after a note."""
    kind = _cartesian(job.source.plain(command.get("type") or "").strip())
    if kind.lower() in {"reactionx", "reactiony", "reactionz"}:
        return _reaction(job, command, kind.lower()[8:])
    of = None
    if any(word in command.attributes for word in ("matname", "mat", "material")):
        number = command.attributes.get("mat") or command.attributes.get("material") or ""
        plain = job.source.plain(number).strip()
        if "matname" not in command.attributes and (plain.startswith("-") or plain == "0"):
            for word in ("mat", "material"):
                command.get(word)
        else:
            of = job.find_material(command)
            if of is None:
                job.note("ignored", command, "there is no such material")
                return None
    low = kind.lower()
    rigid = [m.key for m in job.materials if m.used and m.is_rigid and m.direction == 8]
    if low.startswith("contact") and low[7:] in job.axes and low[7:] and rigid and "contact" in job.scene:
        return f"contact_force_{low[7:]}[{rigid[0]}]"
    if low in _GLOBALS:
        why = _missing(job, _GLOBALS[low])
        if why:
            job.note("ignored", command, f"{_GLOBALS[low]}: {why}")
            return None
        if of is not None:
            job.note("changed", command, f"{_GLOBALS[low]} is that of all bodies")
        return _GLOBALS[low]
    if of is not None and of.is_rigid:
        job.note("ignored", command, "rigid bodies have no such result")
        return None
    owners = [of] if of is not None and of.used else [m for m in job.materials if m.used and not m.is_rigid]
    if not owners:
        job.note("ignored", command, "its material is in no body")
        return None
    key = owners[0].key
    bodies = [body for body, material in names if material == key]
    for word, column in _OF_MATERIAL.items():
        rest = low.removeprefix(word)
        if rest == low and word != low:
            continue
        exists = rest == "zz" or set(rest) <= set(job.axes)
        if word in {"s", "e"} and rest in _TENSOR and exists and bodies:
            return f"{column}{rest}[{key}]"
        if word in {"vel", "disp"} and rest in {"x", "y", "z"} and exists and len(bodies) == 1:
            return f"{column}{rest}[{bodies[0]}]"
        if word == "temp" and rest in {"", "erature"} and job.heats:
            return f"temperature[{key}]"
    job.note("ignored", command, f"the quantity '{kind}' is not archived")
    return None


def _missing(job: Job, column: str) -> str:
    """Why the scene lacks a column; empty if it has it."""
    faces = (job.scene.get("contact"), job.scene.get("cracks"))
    if column in {"heat_inflow", "thermal_energy"} and "heat" not in job.scene:
        return "nothing conducts heat in this file"
    if column == "contact_work" and not any(faces):
        return "nothing is in contact"
    if column == "interface_energy" and "_interface'" not in str(faces):
        return "there is no interface with stiffnesses"
    return ""


def _reaction(job: Job, command: Command, axis: str) -> str | None:
    """The reaction of the condition that has the number of the command as its ``id``; without one that of all."""
    asked = command.get("mat") or command.get("material") or "0"
    command.get("matname")
    number = abs(round(job.plain(Command("mat", {}, command.line, asked), None)))
    named = [
        str(made["name"]) for label, made in job.conditions if "name" in made and number in {0, abs(label)}
    ]
    if axis in job.axes and len(named) == 1:
        return f"reaction_{axis}[{named[0]}]"
    columns = ", ".join(f"reaction_{axis}[{name}]" for name in named[:5])
    words = f"the reaction is the sum of the columns {columns}" if columns else ""
    words = words or f"no condition has the id {number}"
    job.note("ignored", command, words if axis in job.axes else f"there is no axis {axis}")
    return None


_PERIODIC = {
    *("FMPMOrder", "XPICOrder", "periodicTime", "periodicCFL", "periodicSteps", "verbose", "GridBCOption"),
    *("periodicTimeConduction", "periodicCFLConduction", "periodicStepsConduction"),
}


def tasks(job: Job, root: Command) -> None:
    """Custom tasks that have a counterpart."""
    for block in (*root.all("CustomTasks"), root):
        for task in block.all("Schedule"):
            name = task.get("name") or ""
            if name == "PeriodicXPIC":
                _periodic(job, task)
            elif name in {"VTKArchive", "HistoryArchive"}:
                job.ignored(task, f"{name}: archive.particles writes VTU files")
            elif name == "AdjustTimeStep":
                job.ignored(task, "AdjustTimeStep: steps follow the current wave speeds")
            elif name not in {"ReverseLoad", *RAMPS}:
                job.unsupported(task, f"the custom task '{name}'")


def _periodic(job: Job, task: Command) -> None:
    found: dict[str, float] = {}
    for parameter in task.all("Parameter"):
        name = parameter.get("name") or ""
        if name not in _PERIODIC:
            job.unsupported(parameter, f"the parameter '{name}' of PeriodicXPIC")
        elif name == "GridBCOption":
            option = job.word(parameter).lower()
            if option in {"lumped", "velocity", "combined"}:
                job.scene["method"]["velocity_conditions"] = option
            else:
                job.unsupported(parameter, f"GridBCOption '{option}'")
        else:
            found[name] = job.plain(parameter, None)
    order = max(1, round(found.get("FMPMOrder", found.get("XPICOrder", 2.0))))
    made: dict[str, Any] = {"kind": "fmpm" if "FMPMOrder" in found else "xpic", "order": order}
    steps, courant, time = (found.get(f"periodic{word}", 0) for word in ("Steps", "CFL", "Time"))
    if steps > 0:
        made |= {"every_steps": round(steps)} if round(steps) > 1 else {}
    elif courant > 0:
        made["every_courant"] = Value(courant)
    elif time > 0:
        job.note("not_supported", task, "periodicTime; every_courant and every_steps are")
    if steps > 0 or courant > 0 or time > 0:  # else the motion is updated by FLIP
        job.scene["method"]["transfer"] = made
        job.made.comments.pop(("method", "transfer"), None)
    if "heat" in job.scene:
        _periodic_heat(job, task, found, order)


def _periodic_heat(job: Job, task: Command, found: dict[str, float], order: int) -> None:
    """FMPM of temperatures; without it they are updated by FLIP."""
    steps = found.get("periodicStepsConduction", 0)
    if steps > 0:
        job.scene["heat"]["transfer"] = {"kind": "fmpm", "order": order}
        if round(steps) > 1:
            job.scene["heat"]["transfer"]["every_steps"] = round(steps)
        if steps < 1:
            job.note("not_supported", task, "periodicStepsConduction below 1, which mixes FMPM and FLIP")
    for name in ("periodicCFLConduction", "periodicTimeConduction"):
        if found.get(name, 0) > 0 and steps <= 0:
            job.note("not_supported", task, f"{name}; periodicStepsConduction is")


def heat(job: Job, root: Command) -> None:
    """Conduction and coupling."""
    read = ("Conduction", "EnergyCoupling", "ContactHeating", "FrictionalHeating")
    given = {inside.name for block in root.all("Thermal") for inside in block.all(*read)}
    adiabatic = "EnergyCoupling" in given
    rubbing = [
        each for block in root.all("Thermal") for each in block.all("ContactHeating", "FrictionalHeating")
    ]
    in_contact = any(inside.name == "MultiMaterialMode" for inside in root.walk())
    if "Conduction" in given:
        job.scene["heat"] = {"friction": bool(rubbing)} if in_contact else {}
    if "Conduction" not in given or not in_contact:
        why = "materials are not in contact" if "Conduction" in given else "nothing conducts heat"
        for each in rubbing:
            job.note("ignored", each, why)
    if adiabatic or "Conduction" in given:
        job.scene["method"]["heating"] = "adiabatic" if adiabatic else "isothermal"


def _shifts(job: Job) -> bool:
    """Whether a material reads the temperature though it does not change."""
    return any(m.kind == 22 or m.command.first("Tref") is not None for m in job.materials)


def temperatures_matter(job: Job, root: Command, header: Command) -> bool:
    """Whether temperatures change, or are other than that without stress."""
    at_rest = job.property(header, "StressFreeTemp")
    job.scene["_at_rest"] = at_rest
    zero = at_rest.number if at_rest is not None else 0.0
    matter = any(True for _ in ramp_commands(root))
    matter |= any(inside.name in {"Conduction", "EnergyCoupling"} for inside in root.walk())
    for command in root.walk():
        if command.name in {"Body", "mp"} and "temp" in command.attributes:
            value = job.number(command, "temp")
            matter = matter or (value is not None and value.number != zero)
    if matter and not zero > 0:
        words = f"a temperature without stress (StressFreeTemp) of {zero:g}; temperatures are absolute here"
        job.note("not_supported", header.last("StressFreeTemp") or header, words)
    elif matter:
        job.scene["_reference"] = at_rest
    elif at_rest is not None and not _shifts(job):
        job.ignored(header, "no temperature changes in this file", "StressFreeTemp")
    return matter
