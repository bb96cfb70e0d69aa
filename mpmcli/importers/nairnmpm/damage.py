"""Materials that soften, and snow."""

from __future__ import annotations

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
    shear = job.property(command, "tauc"), job.property(command, "II-Gc", "energy_rate")
    laws = {name: command.last(name) for name in ("SofteningI", "SofteningII")}
    names = {
        name: "Linear" if law is None else job.source.plain(law.text).strip() for name, law in laws.items()
    }
    for inside in command.all("largeRotation", "shearFailureSurface", "I-min", "II-min"):
        job.ignored(inside, "large rotations are always taken into account; shear has one strength")
    for inside in command.all("Initiation"):
        if job.source.plain(inside.text).strip() not in {"MaxPrinciple", "1"}:
            job.unsupported(inside, "another criterion than the largest principal stress")
    for inside in command.all("coefVariation"):
        if job.plain(inside, None):
            job.unsupported(inside, "strengths that vary at random; use a points file or an expression")
    for inside in command.all("coefVariationMode"):
        job.ignored(inside, "nothing varies")
    if found is None:
        return None
    if strength is None or toughness is None:
        job.note("not_supported", command, "softening without bound: sigmac and I-Gc are needed")
        return None
    if names["SofteningI"] not in _SOFTENING:
        job.note("not_supported", command, f"the softening law {names['SofteningI']}")
        return None
    if job.analysis == "axisymmetric":
        job.note("not_supported", command, "softening in axisymmetric analyses")
        return None
    tangential, sliding = shear
    if tangential is not None and tangential.scaled < strength.scaled:
        job.note("not_supported", command, "a shear strength tauc below the tensile strength sigmac")
        return None
    if tangential is not None or sliding is not None or laws["SofteningII"] is not None:
        job.changed(
            command, "shear of a crack softens with its opening; tauc, II-Gc and SofteningII are left"
        )
    made = {"kind": "isotropic_softening", **found, "strength": strength, "toughness": toughness}
    law = _SOFTENING[names["SofteningI"]]
    return made if law == "linear" else made | {"softening": law}


def snow(job: Job, material: Material) -> Made | None:
    """Clamped neo-Hookean elasticity."""
    command = material.command
    foreign = [inside for inside in command.children if inside.name in {"yield", "rhoW", "tayM1", "burg"}]
    if foreign:
        job.unsupported(command, "material type 29 of the branch Fagan (dislocations)")
        return None
    found = elastic_constants(job, material)
    made: Made = {"kind": "clamped_neo_hookean", **(found or {})}
    for theirs, ours in (("CritComp", "compression"), ("CritTens", "extension"), ("xihard", "hardening")):
        value = job.property(command, theirs)
        if value is not None:
            made[ours] = value
    model = command.last("Elastic")
    if model is None or round(job.plain(model, None)) == 0:
        job.changed(command, "the elastic law is neo-Hookean here, corotated in NairnMPM (Elastic 0)")
    for inside in command.all("UJOption"):
        job.ignored(inside, "the volumetric energy is (λ/2)(½(J² − 1) − ln J)")
    return made if found is not None else None
