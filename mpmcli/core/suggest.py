"""The nearest name, for messages such as "did you mean 'friction'?"."""

import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import islice

MAX_WORD = 80
"""Longer words are like no name."""
MAX_NAMES = 500
"""So many names are compared with a word."""
MAX_SEARCHES = 20
"""So many suggestions are made for one scene: the search takes longer than all else that finds a problem."""

_searches_left: ContextVar[list[int] | None] = ContextVar("_searches_left", default=None)


@contextmanager
def few_suggestions() -> Iterator[None]:
    """Look for the nearest name for the first problems only, of all that are found inside."""
    if _searches_left.get() is not None:
        yield
        return
    token = _searches_left.set([MAX_SEARCHES])
    try:
        yield
    finally:
        _searches_left.reset(token)


def searches_are_left() -> bool:
    """Return whether a further suggestion may be looked for."""
    left = _searches_left.get()
    return left is None or left[0] > 0


OTHER_WORDS = {
    # keys
    "archive": "output outputs results save write dump",
    "around": "ambient environment surroundings t_inf t_ambient ambient_temperature",
    "axis": "normal_axis",
    "bodies": "objects parts geometries",
    "boundary": "boundaries bc bcs boundary_conditions conditions supports constraints",
    "cell": "dx h spacing cell_size cellsize mesh_size resolution",
    "center": "centre middle position",
    "coefficient": "film_coefficient heat_transfer_coefficient",
    "columns": "quantities variables",
    "conductance": "contact_conductance",
    "conductivity": "kappa thermal_conductivity lambda",
    "constants": "parameters params variables definitions",
    "courant": "cfl courant_number",
    "density": "rho mass_density",
    "E": "young youngs youngs_modulus young_modulus elastic_modulus modulus",
    "end": "duration t_end tend end_time final_time tmax t_max stop total_time",
    "step": "dt delta_t timestep time_step step_size",
    "every": "interval period frequency freq dt output_interval",
    "expansion": "alpha cte thermal_expansion expansion_coefficient",
    "fields": "quantities variables",
    "flux": "q",
    "fourier": "fourier_number",
    "friction": "mu coefficient friction_coefficient",
    "G": "mu shear shear_modulus",
    "globals": "csv table tables history",
    "grid": "mesh background_grid domain",
    "heat": "thermal conduction heat_conduction",
    "heat_capacity": "c cv cp c_v c_p specific_heat",
    "K": "bulk bulk_modulus",
    "loads": "forces load",
    "lower": "min minimum origin from",
    "max_steps": "steps nsteps n_steps num_steps number_of_steps",
    "method": "solver scheme algorithm numerics",
    "nu": "poisson poissons_ratio poisson_ratio v",
    "particles": "vtu vtk",
    "particles_per_axis": "ppc ppa ppd particles_per_cell particles_per_direction",
    "plane": "surface",
    "probes": "sensors trackers tracers gauges",
    "radius": "r rad",
    "region": "geometry shape",
    "shape": "shape_function basis interpolation",
    "T0": "reference_temperature stress_free_temperature t_ref tref",
    "strength": "tensile_strength ft sigma_c",
    "temperature": "initial_temperature dirichlet",
    "time": "times simulation run",
    "title": "name description",
    "toughness": "fracture_energy gf g_c gc",
    "upper": "max maximum to",
    "velocity": "v v0 initial_velocity speed",
    # kinds
    "bingham": "slurry mud viscoplastic yield_stress_fluid",
    "bitmap": "image picture png",
    "box": "rectangle rect square cube cuboid block brick rectangular",
    "clamped_neo_hookean": "snow clamped_neohookean",
    "coulomb": "friction frictional amontons",
    "difference": "ring annulus subtract",
    "disk": "circle disc round",
    "drucker_prager": "druckerprager",
    "ellipse": "oval",
    "film": "convection robin newton_cooling",
    "fmpm": "pic",
    "granular": "mu_i grains sand",
    "gravity": "weight",
    "heat_flux": "neumann",
    "heat_source": "source heating",
    "hill_plastic": "hill hill48 anisotropic_plastic orthotropic_plastic hillplastic",
    "ideal_gas": "gas air",
    "isotropic_softening": "brittle damage smeared_crack isosoftening concrete",
    "j2_plastic": "plastic j2 von_mises mises elastoplastic johnson_cook",
    "lcpdi": "cpdi cpdi1",
    "linear_elastic": "elastic hooke linear isotropic",
    "mesh": "stl obj surface",
    "modified_cam_clay": "cam_clay camclay clay mcc",
    "mohr_coulomb": "mohrcoulomb soil rock",
    "mooney_rivlin": "mooney rivlin",
    "neo_hookean": "hyperelastic rubber neohookean neohooke",
    "orthotropic": "anisotropic wood",
    "plane_strain": "2d planar plane",
    "power_law": "ludwik ludwig nonlinear",
    "qcpdi": "cpdi2",
    "rigid": "solid_wall",
    "sphere": "ball",
    "steinberg_cochran_guinan": "scg scgl steinberg steinberg_guinan",
    "swift": "power hollomon",
    "symmetry": "mirror roller symmetric",
    "tait_fluid": "fluid water liquid newtonian newtonian_fluid",
    "traction": "pressure",
    "transversely_isotropic": "transiso transversal transverse fibre fiber",
    "ugimp": "gimp",
    "uniaxial_stress": "1d",
    "viscoelastic": "maxwell generalized_maxwell generalised_maxwell prony zener polymer",
    # axes of axisymmetric analyses
    "x": "r",
}
"""Names of scenes, and other words that people know for them; of a word with several meanings the first counts."""

_NAMES_OF: dict[str, list[str]] = {}
for _name, _words in OTHER_WORDS.items():
    for _word in _words.split():
        _NAMES_OF.setdefault(_word, []).append(_name)


def meanings(word: str) -> list[str]:
    """Return the names that an other word stands for, and the word itself first."""
    plain = word.lower().replace("-", "_").replace(" ", "_").replace("'", "")
    return [plain, *_NAMES_OF.get(plain, ())]


def synonym(word: str, names: Iterable[str]) -> str | None:
    """Return the name that the word is another word for, or None."""
    by_lower = {str(name).lower(): str(name) for name in names}
    return next((by_lower[name.lower()] for name in meanings(word) if name.lower() in by_lower), None)


def nearest(word: str, names: Iterable[str]) -> str | None:
    """Return the name that the word means or is most like, or None if none is alike."""
    left = _searches_left.get()
    if len(word) > MAX_WORD or not searches_are_left():
        return None
    if left is not None:
        left[0] -= 1
    names = [str(name) for name in islice(names, MAX_NAMES) if len(str(name)) <= MAX_WORD]
    meant = synonym(word, names)
    if meant is not None:
        return meant
    by_lower = {name.lower(): name for name in names}
    # "energy" means kinetic_energy, although center_y is more like it
    found = [name for name in by_lower if word.lower() in name.split("[")[0].split("_")]
    found = found or difflib.get_close_matches(word.lower(), by_lower, n=1, cutoff=0.55)
    return by_lower[found[0]] if found else None


def did_you_mean(word: str, names: Iterable[str]) -> str:
    """``"; did you mean 'name'?"``, or nothing if no name is alike."""
    name = nearest(word, names)
    return f"; did you mean '{name}'?" if name is not None and name != word else ""


def listing(names: Iterable[str], limit: int = 12) -> str:
    """Names with commas between, the last ones replaced by an ellipsis if there are many."""
    every = [str(name) for name in names]
    return ", ".join(every[:limit]) + (", …" if len(every) > limit else "")
