"""Materials of the source by the names of mpmcli."""

import math
from collections.abc import Callable
from typing import Any

from mpmcli.importers.base import free_name
from mpmcli.importers.cbgeo.reading import Keys
from mpmcli.importers.cbgeo.source import (
    Bingham,
    LinearElastic,
    Material,
    ModifiedCamClay,
    MohrCoulomb,
    Newtonian,
    OtherMaterial,
    family,
)
from mpmcli.importers.cbgeo.work import Work

NAMES = {
    "LinearElastic": "elastic",
    "Newtonian": "fluid",
    "Bingham": "paste",
    "MohrCoulomb": "soil",
    "ModifiedCamClay": "clay",
}
"""What a material is called in the scene."""
SMALL_STRAIN = (
    "stress is that of logarithmic strain and turns with the material; CB-Geo adds increments of small strain"
)

INCOMPRESSIBLE = "incompressible fluids; every fluid has a bulk modulus"


def add_materials(work: Work) -> dict[int, str]:
    """Translate the materials that particles have; their names by their numbers."""
    used = set(work.cloud.material.tolist())
    names: dict[int, str] = {}
    made = work.scene.setdefault("materials", {})
    seen: set[int] = set()
    for index, material in enumerate(work.given.source.materials):
        keys: Keys = ("materials", index)
        if material.id in seen:
            work.fault((*keys, "id"), f"the material {material.id} is already defined")
            continue
        seen.add(material.id)
        if material.id not in used:
            work.note("ignored", keys, f"no particle has the material {material.id}")
            continue
        translated = _translate(work, material, keys)
        if translated is not None:
            names[material.id] = free_name(NAMES.get(family(material.type), "elastic"), made, " ")
            made[names[material.id]] = translated
            work.place(("materials", names[material.id]), keys)
    for number in sorted(used - seen):
        index = work.cloud.generator[(work.cloud.material == number).argmax()]
        at = ("particles", int(index), "generator", "material_id")
        work.fault(at, f"there is no material {number}")
    return names


def _translate(work: Work, material: Material, keys: Keys) -> dict[str, Any] | None:
    if isinstance(material, OtherMaterial):
        work.lacks((*keys, "type"), f"the material '{material.type}'")
        return _stand_in(material)
    return _MAKERS[type(material)](work, material, keys)


def _stand_in(material: Material) -> dict[str, Any] | None:
    """The elastic part of a material that is not supported, for scenes that may be partial."""
    extra = material.model_extra or {}
    E, nu = extra.get("youngs_modulus"), extra.get("poisson_ratio")
    numbers = {"density": material.density, "E": E, "nu": nu}
    if not all(isinstance(number, int | float) for number in numbers.values()):
        return None
    return {"kind": "linear_elastic", **numbers}


def _elastic(work: Work, given: LinearElastic, keys: Keys) -> dict[str, Any]:
    work.note("changed", (*keys, "type"), SMALL_STRAIN)
    return {"kind": "linear_elastic", **_hooke(given)}


def _hooke(given: LinearElastic) -> dict[str, Any]:
    return {"density": given.density, "E": given.youngs_modulus, "nu": given.poisson_ratio}


def _newtonian(work: Work, given: Newtonian, keys: Keys) -> dict[str, Any] | None:
    if given.incompressible:
        work.lacks((*keys, "incompressible"), INCOMPRESSIBLE)
    words = (
        "the pressure follows Tait's equation; CB-Geo's, -K ln J, differs where volumes change by percents"
    )
    work.note("changed", (*keys, "type"), words)
    made = {"kind": "tait_fluid", "density": given.density, "K": given.bulk_modulus}
    return made | ({"viscosity": given.dynamic_viscosity} if given.dynamic_viscosity else {})


def _bingham(work: Work, given: Bingham, keys: Keys) -> dict[str, Any] | None:
    if given.incompressible:
        work.lacks((*keys, "incompressible"), INCOMPRESSIBLE)
    words = "below the yield stress it is elastic, with G of K/10; the pressure follows Tait's equation"
    work.note("changed", (*keys, "type"), words)
    if given.critical_shear_rate:
        work.note("ignored", (*keys, "critical_shear_rate"), "no shear rate is cut off")
    return {
        "kind": "bingham",
        "density": given.density,
        "K": given.youngs_modulus / (3 * (1 - 2 * given.poisson_ratio)),
        "viscosity": given.mu,
        "yield_stress": given.tau0,
    }


def _mohr_coulomb(work: Work, given: MohrCoulomb, keys: Keys) -> dict[str, Any] | None:
    names = ("cohesion", "friction", "dilation")
    strength = {name: getattr(given, name) for name in names}
    made: dict[str, Any] = {"kind": "mohr_coulomb", **_hooke(given), **strength}
    apex = given.cohesion / math.tan(math.radians(given.friction)) if given.friction else math.inf
    if given.tension_cutoff < apex:
        made["tension"] = given.tension_cutoff
    words = "plastic flow is normal to planes with the angle of dilation; CB-Geo's potential is smooth"
    work.note("changed", (*keys, "type"), f"{words} (Menétrey-Willam)")
    if given.softening is False:
        work.note("ignored", (*keys, "softening"), "switched off; the residual values have no effect")
    softens = given.softening is not False and given.peak_pdstrain is not None
    if softens and given.residual_pdstrain is not None:
        residual = {name: getattr(given, f"residual_{name}") for name in names}
        changed = {f"residual_{name}": v for name, v in residual.items() if v not in (None, made[name])}
        if changed:
            made |= changed
            made |= {"softening_start": given.peak_pdstrain, "softening_end": given.residual_pdstrain}
    return made


_EXTENSIONS = {
    "subloading": ("subloading_u",),
    "bonding": ("s_h", "mc_a", "mc_b", "mc_c", "mc_d", "m_degradation", "m_shear"),
}
"""Numbers of the extensions of Cam clay."""


def _cam_clay(work: Work, given: ModifiedCamClay, keys: Keys) -> dict[str, Any] | None:
    for option in ("three_invariants", "subloading", "bonding"):
        if getattr(given, option):
            work.lacks((*keys, option), "an extension of the plain model")
    for option, names in _EXTENSIONS.items():
        for name in names:
            if getattr(given, name) is not None and not getattr(given, option):
                work.note("ignored", (*keys, name), f"{option} is switched off")
    pressure = given.pc0 / given.ocr
    start = {"pressure": pressure} if work.cloud.stress is None else {}
    if start:
        words = (
            "starts at the pressure pc0/ocr, to which its void ratio belongs; CB-Geo starts without stress"
        )
        work.note("changed", (*keys, "type"), words)
    work.note("ignored", (*keys, "youngs_modulus"), "the elastic moduli follow from kappa and the pressure")
    e0 = given.e_ref - given.lambda_ * math.log(pressure / given.p_ref) - given.kappa * math.log(given.ocr)
    return {
        "kind": "modified_cam_clay",
        "density": given.density,
        "M": given.m,
        "lambda": given.lambda_,
        "kappa": given.kappa,
        "nu": given.poisson_ratio,
        "p0": given.pc0,
        "e0": e0,
        **start,
    }


_MAKERS: dict[type[Material], Callable[[Work, Any, Keys], dict[str, Any] | None]] = {
    LinearElastic: _elastic,
    Newtonian: _newtonian,
    Bingham: _bingham,
    MohrCoulomb: _mohr_coulomb,
    ModifiedCamClay: _cam_clay,
}
