"""Materials that soften, and snow."""

from typing import Any

from mpmcli.importers.nairnmpm.constants import elastic_constants
from mpmcli.importers.nairnmpm.job import Job, Material

Made = dict[str, Any]
_SOFTENING = {"Linear": "linear", "1": "linear", "Exponential": "exponential", "2": "exponential"}


def softening(job: Job, material: Material) -> Made | None:
    """Elasticity with a smeared crack: one strength and one toughness."""
    command = material.command
    found = elastic_constants(job, material)
    strength = job.property(command, "sigmac")
    toughness = job.property(command, "I-Gc", "energy_rate", shown=True)
    tangential, sliding = job.property(command, "tauc"), job.property(command, "II-Gc", "energy_rate")
    name, second = job.word(command.last("SofteningI"), "Linear"), command.last("SofteningII")
    job.ignored(
        command,
        "large rotations are always taken into account; shear has one strength",
        "largeRotation shearFailureSurface I-min II-min",
    )
    for inside in command.all("Initiation"):
        if job.word(inside) not in {"MaxPrinciple", "1"}:
            job.unsupported(inside, "another criterion than the largest principal stress")
    for inside in command.all("coefVariation"):
        if job.plain(inside, None):
            job.unsupported(inside, "strengths that vary at random; use a points file or an expression")
    if found is None:
        return None
    if strength is None or toughness is None:
        job.note("not_supported", command, "softening without bound: sigmac and I-Gc are needed")
        return None
    if name not in _SOFTENING:
        job.note("not_supported", command, f"the softening law {name}")
        return None
    if job.analysis == "axisymmetric":
        job.note("not_supported", command, "softening in axisymmetric analyses")
        return None
    if tangential is not None and tangential.scaled < strength.scaled:
        job.note("not_supported", command, "a shear strength tauc below the tensile strength sigmac")
        return None
    if tangential is not None or sliding is not None or second is not None:
        words = "shear of a crack softens with its opening; tauc, II-Gc and SofteningII are left"
        job.changed(command, words)
    made = {"kind": "isotropic_softening", **found, "strength": strength, "toughness": toughness}
    return made if _SOFTENING[name] == "linear" else made | {"softening": _SOFTENING[name]}


def snow(job: Job, material: Material) -> Made | None:
    """Clamped neo-Hookean elasticity."""
    command = material.command
    if any(command.first(name) is not None for name in ("yield", "rhoW", "tayM1", "burg")):
        job.unsupported(command, "material type 29 of the branch Fagan (dislocations)")
        return None
    found = elastic_constants(job, material)
    names = {"CritComp": "compression", "CritTens": "extension", "xihard": "hardening"}
    made: Made = {"kind": "clamped_neo_hookean", **(found or {}), **job.properties(command, names)}
    if job.code(command, "Elastic", 0) == 0:
        job.changed(command, "the elastic law is neo-Hookean here, corotated in NairnMPM (Elastic 0)")
    job.ignored(command, "the volumetric energy is (λ/2)(½(J² − 1) − ln J)", "UJOption")
    return made if found is not None else None
