"""Elastic constants and hardening laws of isotropic materials."""

import math
from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job, Material
from mpmcli.importers.nairnmpm.values import Value

Made = dict[str, Any]


def elastic_constants(job: Job, material: Material, bulk: str = "K", shear: str = "G") -> Made | None:
    """Elastic constants: E and nu, or K and G."""
    command = material.command
    E, nu = job.property(command, "E"), job.property(command, "nu")
    K, G = job.property(command, bulk), job.property(command, shear)
    made: Made
    if E is not None and nu is not None:
        made = {"E": E, "nu": nu}
        for name in (name for name, value in ((bulk, K), (shear, G)) if value is not None):
            job.note("ignored", command, f"{name}: E and nu are given")
    elif K is not None and G is not None:
        made = {"K": K, "G": G}
    elif G is not None and (E is not None or nu is not None):
        other = quotient(E.scaled, 2 * G.scaled) - 1 if E is not None else nu.scaled  # type: ignore[union-attr]
        modulus = E if E is not None else Value(2 * G.scaled * (1 + other))
        made = {"E": modulus, "nu": nu if nu is not None else other}
    else:
        job.error(command, f"elastic constants are missing: two of E, nu, {shear}, or {bulk} and {shear}")
        return None
    return made


def quotient(a: float, b: float) -> float:
    """The quotient of two numbers, infinite where the second is 0: the scene's own check refuses that."""
    return a / b if b else math.inf


def _steinberg(job: Job, command: Command) -> Made | None:
    """Steinberg, Cochran and Guinan's hardening; by default that of tungsten without hardening, as in NairnMPM."""
    largest = job.needed(command, "yieldMax", why=", the largest yield stress")
    defaults = {"yield": 2200.0, "betahard": 0.0, "nhard": 1.0, "GPpG0": 1e-5}
    if job.heats:
        defaults["GTpG0"] = -2.2e-4
    else:
        job.ignored(command, "no temperature changes in this file", "GTpG0")
    given = {name: job.property(command, name) for name in defaults}
    if largest is None:
        return None
    for name in (name for name, value in given.items() if value is None):
        job.changed(command, f"without {name}, NairnMPM's value is {defaults[name]:g}")
    found = {name: value or Value(defaults[name]) for name, value in given.items()}
    made: Made = {"kind": "steinberg_cochran_guinan", "yield_stress": found["yield"], "Y_max": largest}
    made |= {"beta": found["betahard"], "n": found["nhard"], "A": found["GPpG0"]}
    if job.heats:
        made["B"] = found["GTpG0"].negative
        if job.scene.get("_reference") is not None:
            made["T0"] = job.scene["_reference"]
    return made


def hardening_law(job: Job, command: Command) -> Made | None:
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
    if law in {"SCGL", "4"}:
        return _steinberg(job, command)
    K, n = get("Khard", 0.0), get("nhard", 1.0)
    if law in {"Nonlinear", "2"} and yield_stress is not None and K.scaled > 0:
        return {"kind": "swift", "yield_stress": yield_stress, "eps0": Value(1 / K.scaled), "n": n}
    if law in {"Nonlinear2", "6"} and yield_stress is not None:
        slope = Value(yield_stress.scaled * K.scaled)
        return {"kind": "power_law", "yield_stress": yield_stress, "B": slope, "n": n}
    if chosen is not None:
        job.unsupported(chosen, f"the hardening law {law}")
    return None
