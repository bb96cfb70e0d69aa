"""Elastic constants of isotropic materials."""

from __future__ import annotations

import math
from typing import Any

from mpmcli.importers.nairnmpm.job import Job, Material
from mpmcli.importers.nairnmpm.values import Value

Made = dict[str, Any]


def elastic_constants(job: Job, material: Material, bulk: str = "K", shear: str = "G") -> Made | None:
    """Elastic constants: E and nu, or K and G; also the wave speed."""
    command = material.command
    E, nu = job.property(command, "E"), job.property(command, "nu")
    K, G = job.property(command, bulk), job.property(command, shear)
    made: Made
    if E is not None and nu is not None:
        made = {"E": E, "nu": nu}
        k = E.scaled / (3 * max(1e-12, 1 - 2 * nu.scaled))
        g = E.scaled / (2 * (1 + nu.scaled))
    elif K is not None and G is not None:
        made, k, g = {"K": K, "G": G}, K.scaled, G.scaled
    elif G is not None and (E is not None or nu is not None):
        other = E.scaled / (2 * G.scaled) - 1 if E is not None else nu.scaled  # type: ignore[union-attr]
        modulus = E if E is not None else Value(2 * G.scaled * (1 + other))
        made = {"E": modulus, "nu": nu if nu is not None else other}
        k, g = modulus.scaled / (3 * max(1e-12, 1 - 2 * other)), G.scaled
    else:
        job.error(
            command,
            f"elastic constants are missing: two of E, nu, {shear}, or {bulk} and {shear}",
        )
        return None
    set_speed(job, material, k + 4 * g / 3)
    return made


def set_speed(job: Job, material: Material, modulus: float) -> None:
    """Note the wave speed of a material with this modulus, if its density is known."""
    rho = material.command.first("rho")
    density = job.number(rho, None, "density") if rho is not None else None
    if density is not None and density.scaled > 0 and modulus > 0:
        material.speed = math.sqrt(modulus / density.scaled)
