"""Materials with an equation of state."""

from typing import Any

from mpmcli.importers.nairnmpm.constants import set_speed
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
    capacity = job.property(command, "Cv") or job.property(command, "Cp")
    if capacity is None or not job.heats:
        made["heat_capacity"] = capacity or Value(1.0)
    job.unsupported(
        command,
        "plasticity with an equation of state",
        "yield Hardening Khard nhard Ep Ajc Bjc njc Cjc ep0jc",
    )
    job.ignored(command, "the equation of state gives the pressure", "UJOption Kmax")
    return made


def tait_fluid(job: Job, material: Material) -> Made | None:
    """Tait liquid."""
    command = material.command
    K = job.needed(command, "K")
    if K is None:
        return None
    job.changed(
        command, "p = (K/n)(J^(−n) − 1) with n = 10.19 has NairnMPM's pressure to second order in J − 1"
    )
    made: Made = {"kind": "tait_fluid", "K": K, "exponent": 10.19}
    viscosity = [job.number(inside, None, "viscosity", shown=True) for inside in command.all("viscosity")]
    if len(viscosity) > 1:
        job.note("not_supported", command, "a viscosity that depends on the rate")
    if viscosity and viscosity[0] is not None:
        made["viscosity"] = viscosity[0]
    set_speed(job, material, K.scaled)
    return made


def ideal_gas(job: Job, material: Material) -> Made | None:
    """Ideal gas."""
    command = material.command
    pressure, rest = job.needed(command, "P0"), job.properties(command, {"T0": "T0"})
    if pressure is None:
        return None
    return {"kind": "ideal_gas", "pressure": pressure, "gamma": Value(5 / 3), **rest}
