"""Materials with an equation of state."""

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
    defaults = {"C0": 4004.0, "S1": 1.35, "gamma0": 1.64}
    for name in (name for name in defaults if name not in made):
        job.changed(command, f"without {name}, NairnMPM's value is {defaults[name]:g}")
        made[name] = Value(defaults[name])
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
    return made


def ideal_gas(job: Job, material: Material) -> Made | None:
    """Ideal gas."""
    command = material.command
    pressure, of_pressure = job.needed(command, "P0"), job.needed(command, "T0")
    capacity = job.property(command, "Cv") or job.property(command, "Cp")
    if pressure is None or of_pressure is None:
        return None
    made: Made = {"kind": "ideal_gas", "pressure": pressure}
    is_diatomic = capacity is not None and capacity.number > 1
    made |= {"gamma": Value(7 / 5 if is_diatomic else 5 / 3), "T0": of_pressure}
    words = "gas with a Cv above 1 has two atoms per molecule, other gas one; Cv follows from P0, T0 and rho"
    job.changed(command, f"{words}, as in NairnMPM")
    start = job.scene["_at_rest"]
    if start is not None and start.scaled > 0 and start.scaled != of_pressure.scaled > 0:
        made |= {"pressure": Value(pressure.scaled * start.scaled / of_pressure.scaled), "T0": start}
        job.changed(command, "the pressure is that at the temperature of the start, P0 StressFreeTemp/T0")
    return made
