"""The custom task ReverseLoad: loads and rigid bodies that hold or reverse once a quantity passes a value."""

import re
from typing import Any

from mpmcli.importers.nairnmpm.archive import column_of
from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.values import Formula

_LOADS = {"particle_force", "traction"}
_PARAMETERS = {"crackNumber", "maxLength", "maxValue", "style", "mat"}
_ACTIONS = {1: "hold", 2: "", 3: "stop"}
"""By style; all others reverse."""
_STYLES = {"reverse": 0, "hold": 1, "nochange": 2, "abort": 3}
_JOULES = {
    *("boundary_work", "contact_work", "external_work", "plastic_work", "stress_work"),
    *("interface_energy", "kinetic_energy", "strain_energy"),
}


def reversal(job: Job, root: Command, names: list[tuple[str, str]]) -> None:
    """Write the tasks as events or as the end of the run. ``names`` are the bodies and their materials."""
    for block in (*root.all("CustomTasks"), root):
        for task in block.all("Schedule"):
            if task.attributes.get("name") == "ReverseLoad":
                _task(job, task, names)


def _task(job: Job, task: Command, names: list[tuple[str, str]]) -> None:
    found: dict[str, Command] = {}
    for parameter in task.all("Parameter"):
        word = parameter.get("name") or ""
        if word.startswith("global "):
            found["global"] = parameter
        elif word in _PARAMETERS:
            found[word] = parameter
        else:
            job.unsupported(parameter, f"the parameter '{word}' of ReverseLoad")
    action = _action(job, found.get("style"))
    when = _of_quantity(job, task, found, names) if "global" in found else _of_crack(job, task, found)
    if when is None or action is None:
        return
    if not action:
        job.note("not_supported", task, "cracks that stop while the load goes on (style 2)")
        return
    if action == "stop":
        job.scene["time"]["stop_when"] = when
        return
    to = _clocked(job, task, action)
    if not to:
        job.note("ignored", task, "no load varies linearly and no rigid body has a constant velocity")
        return
    events = job.scene.setdefault("events", [])
    name = "reversal" if not events else f"reversal_{len(events) + 1}"
    events.append({"name": name, "when": when, "do": action, "to": to})
    if "global" not in found:
        job.changed(task, "cracks may go on to grow")
    if action == "reverse":
        job.changed(task, "the run goes on after the loads are back at their start; NairnMPM ends it there")


def _action(job: Job, style: Command | None) -> str | None:
    """What happens to the loads, by the number or the word of a style, or None after a note."""
    if style is None:
        return "reverse"
    word = job.word(style).lower()
    try:
        number = _STYLES[word] if word in _STYLES else round(float(word))
    except (ValueError, OverflowError):
        job.note("not_supported", style, f"the style '{word[:40]}'")
        return None
    return _ACTIONS.get(number, "reverse")


def _of_quantity(
    job: Job, task: Command, found: dict[str, Command], names: list[tuple[str, str]]
) -> Formula | None:
    """A column that passes a value, from below if the value is positive, from above if it is negative."""
    kind = (found["global"].get("name") or "").removeprefix("global ").strip()
    asked = Command("Parameter", {"type": kind}, found["global"].line)
    if "mat" in found and job.plain(found["mat"], None) > 0:
        asked.attributes["mat"] = found["mat"].text
    column = column_of(job, asked, names)
    limit = found.get("maxValue") or found.get("maxLength")
    factor = 1.0
    if column is not None and column.startswith("velocity"):
        factor = job.unit("velocity").factor
    elif column in _JOULES and job.legacy:
        factor = 1e3
    if column is None or re.match(r"strain_[xyz]", column):
        job.note("not_supported", task, f"reversal by the quantity '{kind}'")
        return None
    value = 10.0 if limit is None else job.plain(limit, None)
    job.changed(task, "the quantity is tested after each step, not when it is archived")
    return Formula(f"{column} {'>=' if value >= 0 else '<='} {value * factor:.12g}")


def _of_crack(job: Job, task: Command, found: dict[str, Command]) -> Formula | None:
    """Any crack, or one of them, that is longer than a value."""
    cracks = job.scene.get("cracks", [])
    if not any("growth" in crack for crack in cracks):
        job.note("ignored", task, "no crack grows")
        return None
    chosen = found.get("crackNumber")
    number = round(job.plain(chosen, None)) if chosen is not None else 0
    limit = found.get("maxLength") or found.get("maxValue")
    value = 10.0 if limit is None else job.plain(limit, None)
    if number > len(cracks):
        job.error(task, f"there is no crack {number}")
        return None
    asked = cracks if number < 1 else [cracks[number - 1]]
    parts = [f"crack_length[{crack['name']}] > {value:.12g}" for crack in asked]
    return Formula(parts[0] if len(parts) == 1 else " + ".join(f"({part})" for part in parts))


def _clocked(job: Job, task: Command, action: str) -> list[str]:
    """Names of loads that depend on t, of rigid bodies with a constant velocity, and of what these hold."""
    to, constant = [], False
    for load in job.scene.get("loads", []):
        if load["kind"] in _LOADS:
            amounts = [*load.get("force", []), *load.get("traction", []), load.get("pressure")]
            varies = any(isinstance(part, Formula) and re.search(r"\bt\b", part.text) for part in amounts)
            constant = constant or not varies
            if varies:
                to.append(str(load["name"]))
    if constant and action == "reverse":
        job.changed(task, "constant loads stay; NairnMPM sets them to 0")
    rigid = {m.key for m in job.materials if m.used and m.is_rigid}
    for body in job.scene["bodies"]:
        moves: list[Any] = body.get("velocity", [])
        if body["material"] in rigid and moves and not any(isinstance(part, Formula) for part in moves):
            to.append(str(body["name"]))
            to += [
                str(condition["name"])
                for condition in job.scene.get("boundary", [])
                if condition.get("on", {}).get("covered_by") == body["name"]
            ]
    return to
