"""Hardening laws of plastic materials."""

from __future__ import annotations

from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.values import Value


def hardening_law(job: Job, command: Command) -> dict[str, Any] | None:
    """The hardening of a material, or None after a note."""
    chosen = command.last("Hardening")
    law = job.word(chosen, "Linear")

    def get(name: str, default: float | None = None, quantity: str = "", shown: bool = False) -> Any:
        found = job.property(command, name, quantity, shown)
        return found if found is not None or default is None else Value(default)

    yield_stress = get("yield")
    if law in {"Linear", "1"}:
        made = {"kind": "linear", "yield_stress": yield_stress or Value(1e12)}
        slope, relative, tangent = get("Ep"), get("Khard"), get("ET")
        if slope is not None and slope.number >= 0:
            made["modulus"] = slope
        elif tangent is not None:
            E = job.property(command, "E")
            if E is not None and E.scaled > tangent.scaled:
                made["modulus"] = Value(E.scaled * tangent.scaled / (E.scaled - tangent.scaled))
        elif relative is not None and relative.number != 0 and yield_stress is not None:
            made["modulus"] = Value(relative.scaled * yield_stress.scaled)
        return made
    if law in {"JohnsonCook", "3"}:
        made = {"kind": "johnson_cook", "A": get("Ajc") or yield_stress or Value(1e12)}
        made |= {"B": get("Bjc", 0.0), "n": get("njc", 1.0), "C": get("Cjc", 0.0)}
        made["eps0_dot"] = get("ep0jc", quantity="frequency", shown=True) or Value(
            1.0, job.unit("frequency"), shown=True
        )
        if job.heats:
            made |= {"m": get("mjc", 1.0), "Tm": get("Tmjc", 1000.0)}
            if job.scene.get("_reference") is not None:
                made["T0"] = job.scene["_reference"]
        else:
            job.ignored(command, "no temperature changes in this file", "mjc Tmjc")
        return made
    if law in {"SCGL", "4"} and yield_stress is not None:
        made = {"kind": "steinberg_cochran_guinan", "yield_stress": yield_stress}
        made["Y_max"] = get("yieldMax", 2500.0)
        made |= {"beta": get("betahard", 27.0), "n": get("nhard", 0.36), "alpha0": get("ep0", 0.0)}
        pressure, temperature = get("GPpG0"), get("GTpG0")
        if pressure is not None and pressure.number != 0:
            made["A"] = pressure
        if temperature is not None and temperature.number != 0:
            made["B"] = temperature.negative
        return made
    K, n = get("Khard", 0.0), get("nhard", 1.0)
    if law in {"Nonlinear", "2"} and yield_stress is not None and K.scaled > 0:
        return {"kind": "swift", "yield_stress": yield_stress, "eps0": Value(1 / K.scaled), "n": n}
    if law in {"Nonlinear2", "6"} and yield_stress is not None:
        slope = Value(yield_stress.scaled * K.scaled)
        return {"kind": "power_law", "yield_stress": yield_stress, "B": slope, "n": n}
    if chosen is not None:
        job.unsupported(chosen, f"the hardening law {law}")
    return None
