"""Keys with which every registered alternative can be tried: a new one is missed by the tests that ask for it here."""

from typing import Any

LINEAR = {"kind": "linear", "yield_stress": 0.02, "modulus": 0.3}
COOK = {"kind": "johnson_cook", "A": 0.02, "B": 0.1, "n": 0.4, "C": 0.02, "Tm": 1500, "m": 1.1}
HARDENINGS: list[dict[str, Any]] = [
    {"kind": "power_law", "yield_stress": 0.02, "B": 0.1, "n": 0.4, "m": 0.02, "eps0_dot": 0.1},
    {
        "kind": "steinberg_cochran_guinan",
        "yield_stress": 0.02,
        "Y_max": 0.05,
        "beta": 30,
        "n": 0.4,
        "A": 0.05,
        "B": 1e-4,
        "Tm": 1500,
    },
    {"kind": "swift", "yield_stress": 0.02, "eps0": 0.01, "n": 0.3, "m": 0.02, "eps0_dot": 0.1},
    {"kind": "voce", "yield_stress": 0.02, "saturation": 0.06, "eps0": 0.05, "modulus": 0.1},
]
ORTHOTROPIC = {
    **{"E1": 3, "E2": 2, "E3": 1, "G12": 0.8, "G13": 0.6, "G23": 0.5},
    **{"nu12": 0.3, "nu13": 0.25, "nu23": 0.35},
}
R_VALUES = {"kind": "r_values", "r0": 0.7, "r45": 0.5, "r90": 0.9}
RATIOS = {"kind": "ratios", "R22": 1.2, "R33": 0.9, "R12": 1.1, "R13": 0.8}
HILL = {"kind": "coefficients", "F": 0.3, "G": 0.5, "H": 0.5, "N": 1.8}
TRANSVERSE = {"E_axial": 3, "E_transverse": 1, "G_axial": 0.6, "nu_axial": 0.3, "nu_transverse": 0.4}

MATERIALS: dict[str, list[dict[str, Any]]] = {
    "linear_elastic": [{"E": 3, "nu": 0.3}, {"K": 2, "G": 1}, {"E": 2, "nu": 0}],
    "neo_hookean": [
        {"E": 3, "nu": 0.3},
        {"E": 3, "nu": 0.3, "volumetric": "log"},
        {"K": 2, "G": 1, "split": "isochoric"},
        {"K": 2, "G": 1, "split": "isochoric", "volumetric": "log"},
    ],
    "mooney_rivlin": [{"G1": 0.7, "G2": 0.3, "K": 2}, {"G1": 0.7, "G2": 0.3, "K": 2, "volumetric": "log"}],
    "mie_gruneisen": [
        {"K": 2, "S1": 1.4, "gamma0": 2, "heat_capacity": 1e-3},
        {"C0": 1.5, "G": 1, "S1": 1.2, "S2": 0.1, "gamma0": 1.5, "heat_capacity": 1e-3},
    ],
    "j2_plastic": [
        {"E": 3, "nu": 0.3, "hardening": LINEAR},
        {"K": 2, "G": 1, "hardening": COOK, "heat_capacity": 1e-3},
        *({"E": 3, "nu": 0.3, "hardening": law} for law in HARDENINGS),
    ],
    "modified_cam_clay": [
        {"M": 1.2, "lambda": 0.8, "kappa": 0.2, "nu": 0.3, "e0": 1, "p0": 0.4, "pressure": 0.2},
        {"M": 0.8, "lambda": 0.3, "kappa": 0.15, "nu": 0.2, "e0": 0.5, "p0": 0.5, "pressure": 0.1},
    ],
    "mohr_coulomb": [
        {"E": 3, "nu": 0.3, "cohesion": 0.02, "friction": 30, "dilation": 10},
        {
            "K": 2,
            "G": 1,
            "cohesion": 0.05,
            "friction": 20,
            "dilation": 5,
            "tension": 0.02,
            "residual_cohesion": 0.01,
            "residual_friction": 15,
            "residual_dilation": 0,
            "softening_start": 0.01,
            "softening_end": 0.1,
        },
    ],
    "bingham": [
        {"K": 2, "viscosity": 0.1, "yield_stress": 0.05},
        {"K": 2, "G": 1, "viscosity": 0, "yield_stress": 0.02, "tension_limit": 0.1},
    ],
    "drucker_prager": [
        {"E": 3, "nu": 0.3, "cohesion": 0.02, "friction": 30, "dilation": 10, "match": "outer"},
        {
            "E": 3,
            "nu": 0.3,
            "cohesion": 0.03,
            "friction": 25,
            "dilation": 0,
            "match": "inner",
            "tension": 0.01,
        },
        {
            "K": 2,
            "G": 1,
            "cohesion": 0.05,
            "friction": 20,
            "dilation": 5,
            "match": "plane_strain",
            "residual_cohesion": 0.01,
            "residual_friction": 15,
            "residual_dilation": 0,
            "softening_end": 0.1,
        },
    ],
    "clamped_neo_hookean": [{"E": 3, "nu": 0.2}],
    "granular": [
        {"E": 3, "nu": 0.3, "mu_s": 0.6, "mu_2": 0.9, "I0": 0.3, "grain_diameter": 0.1, "grain_density": 1.5},
        {"K": 2, "G": 1, "mu_s": 0.7, "mu_2": 0.7, "grain_diameter": 0.1, "grain_density": 1.5},
    ],
    "hill_plastic": [
        {**ORTHOTROPIC, "hardening": law, "anisotropy": anisotropy, "heat_capacity": 1e-3}
        for law, anisotropy in zip(
            [LINEAR, COOK, *(each for each in HARDENINGS if each["kind"] != "steinberg_cochran_guinan")],
            [R_VALUES, RATIOS, HILL, HILL, HILL],
            strict=True,
        )
    ],
    "ideal_gas": [{"pressure": 0.7}],
    "isotropic_softening": [
        {"E": 3, "nu": 0.3, "strength": 0.1, "toughness": 0.05},
        {"K": 2, "G": 1, "strength": 0.1, "toughness": 0.05, "softening": "exponential"},
    ],
    "orthotropic": [ORTHOTROPIC],
    "tait_fluid": [{"K": 2}, {"K": 2, "viscosity": 0.1}, {"K": 2, "tension_limit": 0.05}],
    "rigid": [{}],
    "transversely_isotropic": [
        {**TRANSVERSE, "axis": "x"},
        {**TRANSVERSE, "axis": "y"},
        {**TRANSVERSE, "axis": "z"},
    ],
    "viscoelastic": [
        {"G": 0.4, "K": 1.5, "terms": [{"time": 0.5, "G": 0.6, "K": 0.5}], "volumetric": "log"},
        {
            "G": 0,
            "K": 2,
            "terms": [{"time": 0.5, "G": 0.6}, {"time": 5, "G": 0.4}, {"time": 0.1, "K": 0.2}],
            "heat_capacity": 1e-2,
            "wlf": {"T_ref": 290},
        },
    ],
}
"""Of each kind of material, numbers of every sub-model (moduli of about 3, for densities of about 1)."""

IN_PLANE_STRAIN: dict[str, int] = {
    "clamped_neo_hookean": 0,
    "hill_plastic": 0,
    "isotropic_softening": 0,
    "j2_plastic": 2,
    "mooney_rivlin": 0,
    "viscoelastic": 0,
}
"""Kinds of which the examples from this one on are compiled for plane strain only, which saves time."""

NORMALS: dict[str, dict[str, Any]] = {"specified": {"vector": [1, 0.2]}}
SEPARATIONS: dict[str, dict[str, Any]] = {}
"""Keys that a normal or separation needs; those that need none are left out."""

BOND = {"normal_strength": 1.5, "shear_strength": 0.7}
TRIANGLE = {"shape": "triangular", "strength": 0.3, "toughness": 0.06}
SHEARED = {"shape": "triangular", "strength": 0.4, "toughness": 0.1}
INTERFACES: dict[str, list[dict[str, Any]]] = {
    "linear_interface": [
        {"normal": 4, "tangential": 2},
        {"normal": "perfect", "tangential": 2},
        {"normal": 0, "tangential": "perfect"},
        {"normal": 1e12, "tangential": 1e-12},
    ],
    "bilinear_interface": [
        {"tension": 4, "compression": 30, "tangential": 2},
        {"tension": 0, "compression": "perfect", "tangential": 0},
        {"tension": 4, "compression": "perfect", "tangential": "perfect"},
        {"tension": 4, "compression": 0, "tangential": 1e12},
    ],
    "morse_interface": [
        {"stiffness": 4, "peak": 0.3},
        {"stiffness": 4, "peak": 0.3, "tangential": 2},
        {"stiffness": 1e6, "peak": 3, "tangential": "perfect"},
    ],
    "cohesive": [
        {"normal": TRIANGLE, "tangential": SHEARED},
        {
            "normal": TRIANGLE,
            "tangential": {
                "shape": "trilinear",
                "opening": 0.4,
                "toughness": 0.1,
                "kink_opening": 0.4,
                "kink_strength": 0.3,
            },
            "mixing": {"kind": "power", "exponent": 1.5},
            "closed": {"kind": "coulomb", "friction": 0.3},
        },
        {
            "normal": {"shape": "cubic", "strength": 0.3, "opening": 0.4},
            "tangential": {"shape": "linear", "stiffness": 2},
            "mixing": {"kind": "power"},
            "closed": {"kind": "frictionless", "stiffness": 20},
        },
        {"normal": TRIANGLE, "tangential": SHEARED, "mixing": {"kind": "coupled"}},
        {
            "normal": {"shape": "exponential", "alpha": 3, "strength": 30, "toughness": 0.6},
            "tangential": {"shape": "exponential", "alpha": 3, "strength": 0.4, "opening": 0.3},
            "mixing": {"kind": "coupled"},
            "closed": {"kind": "stick"},
        },
    ],
}
"""Of each interface law, numbers of every sub-model."""
LAWS: dict[str, list[dict[str, Any]]] = INTERFACES | {
    "frictionless": [{}, {"stiffness": 2}],
    "coulomb": [
        {"friction": 0.3},
        {"friction": 0},
        {"friction": 0.3, "static_friction": 0.5},
        {"friction": 1},
        {"friction": 100},
        {"friction": 0.3, "stiffness": 2},
    ],
    "stick": [{}, {"stiffness": 2}],
    "perfect": [{}],
    "none": [{}],
    "adhesion_friction": [{**BOND, "friction": 0.2}, {**BOND, "friction": 0}, {**BOND, "friction": 100}],
    "velocity_friction": [
        {"friction": 0.3},
        {"friction": 0.1, "static_friction": 0.6, "characteristic_speed": 0.4},
        {"friction": 0.6, "static_friction": 0.1, "characteristic_speed": 0.4, "viscosity": 0.2},
        {"friction": 0, "viscosity": 3},
        {"friction": 0},
    ],
}
"""Of each contact law, numbers of every sub-model; the first are those of an ordinary scene."""


def material(kind: str, numbers: dict[str, Any], density: float = 0.9) -> dict[str, Any]:
    """The scene's words for one example of a material."""
    return {"kind": kind, **({} if kind == "rigid" else {"density": density}), **numbers}


CRITERIA: dict[str, dict[str, Any]] = {
    "empirical": {"K_Ic": 1.0, "K_IIc": 0.8},
    "energy_release_rate": {"J_c": 0.5},
    "maximum_hoop_stress": {"K_Ic": 1.0},
    "opening": {"normal": 0.01, "tangential": 0.02},
    "steady_speed": {"speed": 0.4},
    "strain_energy_density": {"K_Ic": 1.0},
}
DIRECTIONS: dict[str, dict[str, Any]] = {
    "given": {"along": [1, 0.5]},
    "weak_plane": {"plane": [1, 0], "ratio": 0.5},
}
"""Keys that a growth criterion or direction needs; those that need none are left out."""


CELLS = {1: [14], 2: [5, 14], 3: [2, 11, 11]}
"""Cells of a block by the number of axes: the longest axes are long enough for bands of every colour."""


def conditions_of(d: int) -> dict[str, list[dict[str, Any]]]:
    """Words of every kind of condition, at the block's ends."""
    cells, corner = CELLS[d], [-4] * d
    low = [1, *[n + 1 for n in cells[1:]]]
    axis = {"axis": "x", "at": 1}
    return {
        "velocity": [
            {"on": {"plane": axis | {"side": "lower"}}, "direction": "x", "value": "0.1*t"},
            {"on": {"box": {"lower": corner, "upper": low}}, "direction": "x", "value": "0.1+x"},
            {
                "on": {"region": {"kind": "box", "lower": corner, "upper": low}},
                "direction": "x",
                "value": 0.1,
            },
            {
                "on": {"body": "block0", "face": {"axis": "x", "side": "upper"}},
                "direction": "x",
                "value": -0.1,
            },
        ],
        "wall": [
            {"normal": [1, *[0] * (d - 1)], "position": "0.5+0.1*t", "velocity": 0.1, "gradient": 0.02},
            *(
                [{"normal": [0.6, 0.8, 0][:d], "position": [0.5, 0.5, 0][:d], "velocity": 0.1}]
                if d > 1
                else []
            ),
        ],
        "symmetry": [{"plane": axis | {"at": 0, "side": "lower"}}],
        "temperature": [
            {"on": {"plane": axis | {"side": "lower"}}, "value": "310+t"},
            {"on": {"box": {"lower": corner, "upper": low}}, "value": "310+x"},
            {"on": {"body": "block0", "face": {"axis": "x", "side": "upper"}}, "value": "310+x+t"},
        ],
    }


def loads_of(d: int) -> dict[str, list[dict[str, Any]]]:
    """Words of every kind of load."""
    vector, face = [0.3, "0.1*t", 0.2][:d], {"axis": "x", "side": "upper"}
    return {
        "absorbing": [{"on": {"body": "block0", "face": face}}],
        "gravity": [{"acceleration": vector}],
        "body_force": [
            {"acceleration": ["0.1*x*t", 0.2, 0.1][:d]},
            {"on": {"body": "block0"}, "acceleration": vector, "coordinates": "initial"},
        ],
        "buoyancy": [{"on": {"body": "block0"}, "level": "2.3+0.1*t", "density": 0.4}],
        "nodal_force": [{"at": [2.5] * d, "force": vector}],
        "particle_force": [
            {"on": {"body": "block0"}, "force": vector, "per": "total"},
            {"on": {"box": {"lower": [0] * d, "upper": [3] * d}}, "force": vector, "per": "particle"},
        ],
        "traction": [
            {"on": {"body": "block0", "face": face}, "traction": vector},
            {"on": {"body": "block0", "face": face}, "pressure": "0.2*x", "coordinates": "current"},
        ],
        "heat_flux": [{"on": {"body": "block0", "face": face}, "flux": "x+t"}],
        "film": [{"on": {"body": "block0", "face": face}, "coefficient": "1+t", "around": 350}],
        "radiation": [
            {
                "on": {"body": "block0", "face": face},
                "emissivity": 0.5,
                "around": 350,
                "stefan_boltzmann": 1e-7,
            }
        ],
        "heat_source": [
            {"on": {"body": "block0"}, "power": "x*t", "per": "volume"},
            {"on": {"body": "block0"}, "power": 0.3, "per": "total"},
        ],
    }
