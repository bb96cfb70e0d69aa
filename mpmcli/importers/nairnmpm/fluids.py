"""Materials with an equation of state."""

from __future__ import annotations

import math
from typing import Any

from mpmcli.importers.nairnmpm.job import Job, Material
from mpmcli.importers.nairnmpm.values import Value

Made = dict[str, Any]


def mie_gruneisen(job: Job, material: Material) -> Made | None:
    """Mie-Grüneisen solid (HEMGEOSMaterial)."""
    command = material.command
    made: Made = {"kind": "mie_gruneisen"}
    for name in ("C0", "G", "S1", "S2", "S3", "gamma0"):
        value = job.property(command, name) or (job.property(command, "G1") if name == "G" else None)
        if value is not None:
            made[name] = value
    made.setdefault("C0", Value(4004.0))
    material.speed = 1.5 * made["C0"].scaled
    if job.property(command, "Cv") is None and job.property(command, "Cp") is None:
        made["heat_capacity"] = Value(1.0)
    elif not job.heats:
        made["heat_capacity"] = job.property(command, "Cv") or job.property(command, "Cp")
    for inside in command.all(
        "yield", "Hardening", "Khard", "nhard", "Ep", "Ajc", "Bjc", "njc", "Cjc", "ep0jc"
    ):
        job.unsupported(inside, "plasticity with an equation of state")
    for inside in command.all("UJOption", "Kmax"):
        job.ignored(inside, "the equation of state gives the pressure")
    return made


def tait_fluid(job: Job, material: Material) -> Made | None:
    """Tait liquid."""
    command = material.command
    K = job.property(command, "K")
    if K is None:
        job.made.error(command.line, "<Material>", "the command <K> is missing")
        return None
    for inside in command.all("InitialPressure", "xi", "function"):
        job.unsupported(inside, "an initial pressure")
    job.changed(
        command, "p = (K/n)(J^(−n) − 1) with n = 10.19 has NairnMPM's pressure to second order in J − 1"
    )
    made: Made = {"kind": "tait_fluid", "K": K, "exponent": 10.19}
    viscosity = [job.number(inside, None, "viscosity", shown=True) for inside in command.all("viscosity")]
    if len(viscosity) > 1:
        job.note("not_supported", command, "a viscosity that depends on the rate")
    if viscosity and viscosity[0] is not None:
        made["viscosity"] = viscosity[0]
    for inside in command.all("logshearrate"):
        job.unsupported(inside, "a viscosity that depends on the rate")
    rho = next((c for c in command.children if c.name == "rho"), None)
    density = job.number(rho, None, "density") if rho is not None else None
    if density is not None and density.scaled > 0:
        material.speed = math.sqrt(K.scaled / density.scaled)
    return made


def ideal_gas(job: Job, material: Material) -> Made | None:
    """Ideal gas."""
    command = material.command
    pressure, T0 = job.property(command, "P0"), job.property(command, "T0")
    if pressure is None:
        job.made.error(command.line, "<Material>", "the command <P0> is missing")
        return None
    made: Made = {"kind": "ideal_gas", "pressure": pressure, "gamma": Value(5 / 3)}
    if T0 is not None:
        made["T0"] = T0
    return made
