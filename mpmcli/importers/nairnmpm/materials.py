"""Materials, by their types in NairnMPM."""

from collections.abc import Callable
from typing import Any

from mpmcli.importers.nairnmpm.anisotropic import ANISOTROPIC, AXIAL, ORTHOTROPIC, hill, with_axes
from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.constants import elastic_constants, hardening_law, quotient
from mpmcli.importers.nairnmpm.damage import snow, softening
from mpmcli.importers.nairnmpm.fluids import ideal_gas, mie_gruneisen, tait_fluid
from mpmcli.importers.nairnmpm.grammar import CONDUCTIVITIES, FRACTURE, TRANSPORT
from mpmcli.importers.nairnmpm.job import Job, Material, slug
from mpmcli.importers.nairnmpm.values import Value

Made = dict[str, Any]
NAMES = {
    10: "two-state isotropic",
    12: "triangular traction law",
    13: "linear traction law",
    14: "cubic traction law",
    19: "wood",
    20: "trilinear traction law",
    21: "anisotropic hyperelastic",
    23: "coupled traction law",
    26: "pressure law",
    60: "contact law",
    61: "Coulomb friction law",
    62: "linear interface law",
    63: "nonlinear interface law",
    64: "adhesive friction law",
    65: "liquid contact law",
}
CONTACT_LAWS = {60, 61, 62, 63, 64, 65}


def number_materials(job: Job, root: Command) -> None:
    """Number the materials as NairnMPM does: those that are named by others first, in the order of naming."""
    taken: set[str] = set()
    listed = []
    for command in root.all("Material"):
        title = job.source.plain(command.attributes.get("Name", ""))
        listed.append(Material(slug(title, taken), round(job.plain(command, "Type")), command, title))
    named = [
        job.source.plain(command.attributes[word])
        for command in root.walk()
        for word in ("matname", "lawname")
        if word in command.attributes
    ]
    by_name = {material.title: material for material in reversed(listed)}
    first = [by_name[name] for name in dict.fromkeys(named) if name in by_name]
    job.materials = first + [material for material in listed if material not in first]
    for material in listed:
        if material.kind == 35:
            material.direction = 8
        elif material.kind == 11:
            material.direction = job.code(material.command, "SetDirection", 0)


def materials(job: Job) -> Made:
    """The materials that bodies have, in the order of the source."""
    made: Made = {}
    for material in sorted(job.materials, key=lambda m: m.command.line):
        if material.kind in CONTACT_LAWS:
            continue
        if not material.used:
            idle = "rigid bodies that hold no direction have no effect"
            job.ignored(material.command, idle if material.idle else "no body has this material")
            continue
        entry = _one(job, material)
        if entry is not None:
            made[material.key] = entry
            if material.title.lower().replace(" ", "_") != material.key:
                job.made.comment(["materials", material.key], material.title)
    return made


def _one(job: Job, material: Material) -> Made | None:
    command = material.command
    if material.is_rigid:
        return {"kind": "rigid"}
    maker = _MAKERS.get(material.kind)
    if maker is None:
        name = NAMES.get(material.kind, "of an unknown type")
        job.unsupported(command, f"material type {material.kind} ({name})")
        return None
    made = maker(job, material)
    if made is not None:
        _common(job, material, made)
    return made


def _common(job: Job, material: Material, made: Made) -> None:
    """Density, expansion, heat, and what has no counterpart."""
    command = material.command
    rho = job.property(command, "rho", "density", shown=True)
    if rho is None:
        rho = Value(1.0, job.unit("density"), shown=True)
        job.changed(command, "without rho, NairnMPM's density is 1")
    made["density"] = rho
    order = ["kind", "density", *(key for key in made if key not in {"kind", "density"})]
    for key in order:
        made[key] = made.pop(key)
    if job.heats:
        _expansion(job, material, made)
        if made["kind"] != "ideal_gas":
            _heat_capacity(job, command, made)
        conductivity = job.property(command, "kCond", "conductivity", shown=True)
        conducts = "heat" in job.scene and not job.scene.get("_insulates")
        if "heat" in job.scene:
            made["conductivity"] = conductivity if conducts and conductivity else Value(0.0)
        if conducts and conductivity is None:
            job.changed(command, "without kCond, NairnMPM's conductivity is 0")
        elif conductivity is not None and not conducts:
            job.note("ignored", command, "kCond: nothing conducts heat in this file")
        reference = job.scene.get("_reference")
        if reference is not None:
            made["T0"] = reference
    else:
        job.ignored(command, "no temperature changes in this file", " ".join(_EXPANSIONS))
    words = "no transport in this file" if not job.heats else "used in NairnMPM's other transport only"
    unused = TRANSPORT.split() + ([] if job.heats else CONDUCTIVITIES.split())
    read = {"Cp", "Cv"} if job.heats or material.kind in _WITH_CAPACITY else set()
    read |= {"kCond"} if job.heats else set()
    for inside in command.all(*(name for name in unused if name not in read)):
        job.ignored(inside, words)
    if not job.scene.get("_cracks"):
        job.ignored(command, "there are no cracks in this file", f"{FRACTURE} Propagate AltPropagate")
    _particle_damping(job, command)


_WITH_CAPACITY = {17, 22, 25}
"""Types of materials whose equation of state reads a heat capacity."""
_EXPANSIONS = ("alpha", "alphaA", "alphaT", "alphax", "alphay", "alphaz")
_EXPANDING = {1, 7, 9, 50}
"""Types of isotropic materials that expand by 40e-6/K without ``alpha``."""


def _expansion(job: Job, material: Material, made: Made) -> None:
    """Thermal expansion, which has to be the same along all axes of a material."""
    command = material.command
    names: tuple[str, ...] = ("alpha",)
    if material.kind in ANISOTROPIC:
        names = ("alphaA", "alphaT") if material.kind in {2, 3} else ("alphax", "alphay", "alphaz")
    found = [job.property(command, name, "expansion") for name in names]
    if material.kind in _EXPANDING | ANISOTROPIC:
        for name in (name for name, value in zip(names, found, strict=True) if value is None):
            job.changed(command, f"without {name}, NairnMPM's expansion is 40e-6/K")
    default = Value(40.0 if material.kind in _EXPANDING | ANISOTROPIC else 0.0, job.unit("expansion"))
    along = [value or default for value in found]
    if any(value.scaled != along[0].scaled for value in along):
        job.note("not_supported", command, f"expansions that differ along axes: {', '.join(names)}")
    elif along[0].number != 0:
        made["expansion"] = along[0]


def _heat_capacity(job: Job, command: Command, made: Made) -> None:
    heat = job.property(command, "Cv") or job.property(command, "Cp")
    if heat is not None:
        made["heat_capacity"] = heat
    elif "heat" in job.scene and "heat_capacity" not in made:
        made["heat_capacity"] = Value(1.0)
        job.changed(command, "without Cv, NairnMPM's heat capacity is 1")


def _particle_damping(job: Job, command: Command) -> None:
    """A damping of particles of one material is that of the scene if no other material has another one."""
    for inside in command.all("PDamping"):
        function = inside.get("function")
        rate: Any = job.number(inside, None, "frequency")
        if function is not None:
            rate = job.formula(inside, function, "frequency")
        others = [m for m in job.materials if m.used and not m.is_rigid and m.command is not command]
        alone = all(_same_damping(job, other, inside) for other in others)
        if inside.get("PIC") or rate is None:
            job.unsupported(inside, "PIC damping; use the transfer xpic")
        elif not alone:
            job.unsupported(inside, "a damping of one material")
        else:
            job.scene["method"].setdefault("damping", {})["particle"] = rate
            job.changed(inside, "the damping of the only material is that of all particles")


def _same_damping(job: Job, other: Material, damping: Command) -> bool:
    found = other.command.first("PDamping")
    if found is None:
        return False
    return (job.word(found), found.attributes) == (job.word(damping), damping.attributes)


# ------------------------------------------------------------------ elasticity


def _isotropic(job: Job, material: Material) -> Made | None:
    found = elastic_constants(job, material)
    return None if found is None else {"kind": "linear_elastic", **found}


_VOLUMETRIC = {0: "j_minus_inverse", 2: "log"}


def _volumetric(job: Job, command: Command) -> str | None:
    code = job.code(command, "UJOption", 0)
    if (option := command.last("UJOption")) is not None and code not in _VOLUMETRIC:
        words = "the energy (K/2)(J − 1)² has no counterpart; (K/2)(½(J² − 1) − ln J) stands for it"
        job.changed(option, words)
    return _VOLUMETRIC.get(code, "j_minus_inverse")


def _neohookean(job: Job, material: Material) -> Made | None:
    lame, G = job.property(material.command, "Lame"), job.property(material.command, "G")
    if lame is not None and G is not None:
        found: Made | None = {"K": Value(lame.scaled + 2 * G.scaled / 3), "G": G}
    else:
        found = elastic_constants(job, material)
    if found is None:
        return None
    return {"kind": "neo_hookean", **found, "volumetric": _volumetric(job, material.command)}


def _mooney(job: Job, material: Material) -> Made | None:
    command = material.command
    second = job.property(command, "G2")
    volumetric = _volumetric(job, command)
    found = elastic_constants(job, material, "K", "G1")
    if found is None:
        return None
    if second is None or second.number == 0:
        return {"kind": "neo_hookean", **found, "volumetric": volumetric, "split": "isochoric"}
    if "K" in found:
        made = {"kind": "mooney_rivlin", "K": found["K"], "G1": found["G"], "G2": second}
        return made | ({"volumetric": volumetric} if volumetric != "j_minus_inverse" else {})
    E, nu = found["E"].scaled, found["nu"].scaled
    first = Value(quotient(E, 2 * (1 + nu)) - second.scaled)
    return {"kind": "mooney_rivlin", "K": Value(quotient(E, 3 * (1 - 2 * nu))), "G1": first, "G2": second}


def _viscoelastic(job: Job, material: Material) -> Made | None:
    """A generalised Maxwell solid: G0, pairs of Gk and tauk [s], and alike for the bulk."""
    command = material.command
    found = elastic_constants(job, material, "K", "G0")
    made: Made = {"kind": "viscoelastic", **(found or {})}
    terms: list[Made] = []
    for count, modulus, time, name in (("ntaus", "Gk", "tauk", "G"), ("ntausK", "Kk", "tauKk", "K")):
        command.last(count)
        moduli = [job.number(inside, None) for inside in command.all(modulus)]
        times = [job.number(inside, None, "time", shown=True) for inside in command.all(time)]
        if len(moduli) != len(times):
            job.error(command, f"as many commands <{modulus}> as <{time}> are needed")
            return None
        terms += [{"time": t, name: m} for m, t in zip(moduli, times, strict=True)]
    for inside in command.all("pressureLaw"):
        if job.plain(inside, None):
            job.unsupported(inside, "an equation of state with viscoelasticity")
    if found is None:
        return None
    if not terms:
        job.changed(command, "without relaxation times, the material is elastic")
        return {"kind": "linear_elastic", **found}
    made["terms"] = terms
    _shift(job, command, made)
    return made


def _shift(job: Job, command: Command, made: Made) -> None:
    """Williams, Landel and Ferry's shift of relaxation times, which Tref switches on, and mref that by moisture."""
    reference = job.property(command, "Tref")
    constants = job.properties(command, {"C1": "C1", "C2": "C2"})
    if reference is not None and reference.scaled >= 0:
        made["wlf"] = constants | {"T_ref": reference}
        at_rest = job.scene.get("_at_rest")
        if not job.heats and at_rest is not None and at_rest.scaled > 0:
            made["T0"] = at_rest  # the temperature throughout
        elif not job.heats:
            del made["wlf"]
            job.note("not_supported", command, "Tref without a temperature (StressFreeTemp) above 0")
    moisture = command.last("mref")
    if moisture is not None and job.plain(moisture, None) >= 0:
        job.unsupported(moisture, "relaxation times that depend on moisture")


# ------------------------------------------------------------------ plasticity


def _plastic(job: Job, material: Material, shear: str = "G") -> Made | None:
    found = elastic_constants(job, material, "K", shear)
    hardening = hardening_law(job, material.command)
    if found is None or hardening is None:
        return None
    return {"kind": "j2_plastic", **found, "hardening": hardening}


def _hyper_plastic(job: Job, material: Material) -> Made | None:
    made = _plastic(job, material, "G1" if material.command.first("G1") is not None else "G")
    _volumetric(job, material.command)
    if made is not None:
        job.changed(material.command, "the elasticity is logarithmic here, neo-Hookean in NairnMPM")
    return made


_MAKERS: dict[int, Callable[[Job, Material], Made | None]] = {
    1: _isotropic,
    2: with_axes("transversely_isotropic", AXIAL, "z"),
    3: with_axes("transversely_isotropic", AXIAL, "y"),
    4: with_axes("orthotropic", ORTHOTROPIC),
    7: _viscoelastic,
    8: _mooney,
    9: _plastic,
    15: hill,
    17: mie_gruneisen,
    22: ideal_gas,
    24: _hyper_plastic,
    25: mie_gruneisen,
    27: tait_fluid,
    28: _neohookean,
    29: snow,
    50: softening,
}
