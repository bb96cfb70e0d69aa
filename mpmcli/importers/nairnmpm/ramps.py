"""Ramps of the temperature of all particles: the tasks ThermalRamp and PropertyRamp, and <Isothermal>.

NairnMPM adds f(t)·ΔT to the temperature of each particle, f from 0 to 1. The heat source c_v ΔT f'(t) per mass in every
body does that here, also beside conduction.
"""

from collections.abc import Iterator
from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.conditions import raw
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.values import Formula, Value

RAMPS = ("ThermalRamp", "PropertyRamp")
_OTHERS = {
    1: "stress or strain across the plane",
    2: "concentrations and pore pressures",
    3: "strengths; region points takes a column 'strength'",
    4: "toughness; region points takes a column 'toughness'",
}
_ON_OFF = {"sigmoidal", "property", "flipped"}
_NUMBERS = {"time", "start", "DeltaT", "Delta", "exponential", "stretch"}
_PICTURE = {
    *("file", "xorigin", "yorigin", "zlevel", "width", "height"),
    *("DeltaTmin", "DeltaMin", "DeltaTmax", "DeltaMax"),
}


def ramp_commands(root: Command) -> Iterator[Command]:
    """Yield the commands that make ramps."""
    for block in root.children:
        if block.name == "Thermal":
            yield from (inside for inside in block.children if inside.name == "Isothermal")
        for task in (block, *block.children):
            if task.name == "Schedule" and task.attributes.get("name") in RAMPS:
                yield task


def read_ramps(job: Job, root: Command) -> None:
    """Switch conduction on for ramps, which come as loads later; before the materials are read."""
    found = [ramp for command in ramp_commands(root) if (ramp := _read(job, command)) is not None]
    job.scene["_ramps"] = found
    if any(ramp["time"] is not None for ramp in found) and "heat" not in job.scene:
        in_contact = any(inside.name == "MultiMaterialMode" for inside in root.walk())
        job.scene["heat"] = {"friction": False} if in_contact else {}
        job.scene["method"].setdefault("heating", "isothermal")
        job.scene["_insulates"] = True


def ramp_loads(job: Job) -> list[dict[str, Any]]:
    """Return the heat sources of all ramps; ramps without duration at the start change the temperatures of bodies."""
    made: list[dict[str, Any]] = []
    for number, ramp in enumerate(job.scene.pop("_ramps"), start=1):
        for body in job.scene["bodies"]:
            material = job.scene["materials"][body["material"]]
            if material["kind"] == "rigid":
                continue
            if ramp["time"] is None:
                before = body.get("temperature", material.get("T0"))
                if isinstance(before, Value):
                    body["temperature"] = Value(before.scaled + ramp["amount"].scaled)
                continue  # temperatures that are not absolute have a note
            capacity = material.get("heat_capacity")
            if capacity is None:
                words = f"a ramp of the temperature of '{material['kind']}'"
                job.note("not_supported", ramp["command"], words)
                break
            power = Formula(f"{raw(capacity)}*{ramp['rate']}", capacity.unit.factor)
            source = {"kind": "heat_source", "on": {"body": body["name"]}, "per": "mass", "power": power}
            name = f"ramp{'' if number == 1 else f'_{number}'}_{body['name']}"
            made.append({"name": name, **source})
    return made


def _read(job: Job, command: Command) -> dict[str, Any] | None:
    """What a ramp says: its change, its duration (None without), and the rate of the change."""
    command.handled = True
    scale, given = "", {}
    if command.name == "Isothermal":
        numbers = {"DeltaT": job.number(command, None)}
        numbers |= {name: job.number(command, name) for name in ("time", "start")}
        given = {name: value for name, value in numbers.items() if value is not None}
    else:
        for parameter in command.all("Parameter"):
            name = parameter.get("name") or ""
            if name in _PICTURE or name.startswith("map "):
                job.unsupported(command, f"{command.attributes['name']}: a picture of changes")
                return None
            if name == "scale":
                formula = job.formula(parameter, parameter.text)
                if formula is None:
                    return None
                scale = f"*({formula.text})"
            elif name in _ON_OFF | _NUMBERS and (value := job.number(parameter, None)) is not None:
                given["DeltaT" if name == "Delta" else name] = value
            elif name not in _ON_OFF | _NUMBERS:
                job.unsupported(parameter, f"the parameter '{name}' of a ramp")
                return None
    kind = round(given["property"].number) if "property" in given else 0
    if kind:
        job.unsupported(command, f"a ramp of {_OTHERS.get(kind, f'the property {kind}')}")
        return None
    return _ramp(job, command, given, scale)


def _ramp(job: Job, command: Command, given: dict[str, Value], scale: str) -> dict[str, Any] | None:
    amount, time = given.get("DeltaT", Value(0.0)), given.get("time")
    if time is None or not time.number > 0:
        if ("start" in given and given["start"].number > 0) or scale:
            job.unsupported(command, "a jump of temperatures during the run or by place")
            return None
        job.changed(command, "the bodies start at the temperature after the ramp")
        return {"command": command, "amount": amount, "time": None}
    start = given.get("start")
    begins = start is not None and start.number > 0
    first = raw(start) if begins and start is not None else "0"
    past = f"(t - {first})" if begins else "t"
    rate = f"{raw(amount)}/{raw(time)}"
    during = f"box(t, {first}, {first} + {raw(time)})" if begins else f"(t < {raw(time)})"
    words = "the temperature is up to one step of the ramp off after it"
    if (lifetimes := given.get("exponential")) is not None and lifetimes.number > 0:
        if (stretch := given.get("stretch")) is not None and stretch.number > 0:
            job.unsupported(command, "a stretched exponential ramp")
            return None
        rate += f"*{raw(lifetimes)}*exp(-{raw(lifetimes)}*{past}/{raw(time)})"
    elif "sigmoidal" in given and given["sigmoidal"].number:
        rate += f"*3/cosh(6*({past}/{raw(time)} - 0.5))**2"
        words += "; without the jumps of 0.25 % of it at both ends"
    job.changed(command, f"a heat source in each body; {words}")
    return {"command": command, "amount": amount, "time": time, "rate": f"{rate}{scale}*{during}"}
