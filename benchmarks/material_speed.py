"""What a step costs with each material, over a step with ``neo_hookean``.

    python benchmarks/material_speed.py [KIND …] [--analysis plane_strain] [--particles 40000] [--rounds 15]

``--analysis`` is also plane_stress, axisymmetric or 3d; materials that the analysis does not allow are left out.
CPU time of one thread, medians; the materials take turns. ``lcpdi``, FLIP, 2 particles per axis and cell. Plastic
materials flow and brittle ones crack in most particles.
"""

from __future__ import annotations

import argparse
import statistics
import time

import yaml

from mpmcli.materials import MATERIALS as KINDS
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

E = {"E": 100.0, "nu": 0.3}
WOOD = {
    **{"E1": 100.0, "E2": 50.0, "E3": 20.0, "G12": 30.0, "G13": 20.0, "G23": 10.0},
    **{"nu12": 0.3, "nu13": 0.3, "nu23": 0.3},
}
SERIES = [{"time": 0.1 * 2**k, "G": 10.0, "K": 2.0} for k in range(8)]
FRICTION = {"cohesion": 0.01, "friction": 30, "dilation": 5}
MATERIALS = {
    "neo_hookean": E | {"kind": "neo_hookean"},
    "linear_elastic": E | {"kind": "linear_elastic"},
    "hill_plastic, linear": WOOD
    | {
        "kind": "hill_plastic",
        "anisotropy": {"kind": "r_values", "r0": 0.7, "r45": 1.4, "r90": 2.0},
        "hardening": {"kind": "linear", "yield_stress": 0.01, "modulus": 1.0},
    },
    "j2_plastic, linear": E
    | {"kind": "j2_plastic", "hardening": {"kind": "linear", "yield_stress": 0.01, "modulus": 1.0}},
    "j2_plastic, power_law": E
    | {"kind": "j2_plastic", "hardening": {"kind": "power_law", "yield_stress": 0.01, "B": 1.0, "n": 0.3}},
    "j2_plastic, power_law with rate": E
    | {
        "kind": "j2_plastic",
        "hardening": {
            "kind": "power_law",
            "yield_stress": 0.01,
            "B": 1.0,
            "n": 0.3,
            "m": 0.02,
            "eps0_dot": 1e-4,
        },
    },
    "j2_plastic, steinberg_cochran_guinan": E
    | {
        "kind": "j2_plastic",
        "hardening": {
            "kind": "steinberg_cochran_guinan",
            "yield_stress": 0.01,
            "Y_max": 1.0,
            "beta": 36,
            "n": 0.45,
            "A": 1e-3,
        },
    },
    "j2_plastic, swift": E
    | {"kind": "j2_plastic", "hardening": {"kind": "swift", "yield_stress": 0.01, "eps0": 0.01, "n": 0.2}},
    "j2_plastic, voce": E
    | {
        "kind": "j2_plastic",
        "hardening": {"kind": "voce", "yield_stress": 0.01, "saturation": 1.0, "eps0": 0.1},
    },
    "mohr_coulomb": E | FRICTION | {"kind": "mohr_coulomb"},
    "drucker_prager": E | FRICTION | {"kind": "drucker_prager", "match": "plane_strain"},
    "granular": E
    | {"kind": "granular", "mu_s": 0.4, "mu_2": 0.6, "grain_diameter": 0.1, "grain_density": 2.0},
    "modified_cam_clay": {
        "kind": "modified_cam_clay",
        "M": 1.0,
        "lambda": 0.1,
        "kappa": 0.02,
        "nu": 0.3,
        "e0": 1.0,
        "p0": 1.0,
    },
    "bingham": {"kind": "bingham", "K": 100.0, "viscosity": 0.01, "yield_stress": 0.01},
    "clamped_neo_hookean": E
    | {"kind": "clamped_neo_hookean", "compression": 1e-3, "extension": 1e-3, "hardening": 1},
    "isotropic_softening, whole": E | {"kind": "isotropic_softening", "strength": 1e3, "toughness": 1e6},
    "isotropic_softening": E | {"kind": "isotropic_softening", "strength": 0.01, "toughness": 1.0},
    "isotropic_softening, exponential": E
    | {"kind": "isotropic_softening", "strength": 0.01, "toughness": 1.0, "softening": "exponential"},
    "mooney_rivlin": {"kind": "mooney_rivlin", "G1": 30.0, "G2": 10.0, "K": 90.0},
    "orthotropic": WOOD | {"kind": "orthotropic"},
    "viscoelastic, 1 term": {"kind": "viscoelastic", "G": 20.0, "K": 80.0, "terms": SERIES[:1]},
    "viscoelastic, 3 terms": {"kind": "viscoelastic", "G": 10.0, "K": 80.0, "terms": SERIES[:3]},
    "viscoelastic, 8 terms": {"kind": "viscoelastic", "G": 1.0, "K": 80.0, "terms": SERIES},
}
"""Words of each case but its density, which is 1."""


def simulation_of(words: dict[str, object], analysis: str, particles: int) -> Simulation:
    """A block that shears and swells."""
    d = 3 if analysis == "3d" else 2
    side = round((particles / 2**d) ** (1 / d))
    scene = {
        "version": 1,
        "analysis": {"kind": analysis},
        "grid": {"lower": [-4] * d, "upper": [side + 4] * d, "cell": 1},
        "method": {"shape": "lcpdi", "transfer": {"kind": "flip"}},
        "materials": {"m": {"density": 1.0} | words},
        "bodies": [
            {
                "name": "b",
                "material": "m",
                "region": {"kind": "box", "lower": [0] * d, "upper": [side] * d},
                "velocity": ["0.05*sin(0.5*y)+0.1*cos(0.5*x)", "0.05*sin(0.5*x)", "0.02*x"][:d],
            }
        ],
        "time": {"end": 1000, "step": 0.02},
    }
    return Simulation(load_scene(yaml.safe_dump(scene)), threads=1)


def main() -> None:
    """Print a line per material."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", metavar="KIND")
    parser.add_argument("--analysis", default="plane_strain")
    parser.add_argument("--particles", type=int, default=40_000)
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    chosen = [
        name
        for name in MATERIALS
        if (not arguments.kinds or name == "neo_hookean" or name.partition(",")[0] in arguments.kinds)
        and arguments.analysis in KINDS[str(MATERIALS[name]["kind"])].analyses
    ]
    runs = {name: simulation_of(MATERIALS[name], arguments.analysis, arguments.particles) for name in chosen}
    seconds: dict[str, list[float]] = {name: [] for name in chosen}
    for run in runs.values():
        for _ in range(30):
            run.step()
    for _ in range(arguments.rounds):
        for name, run in runs.items():
            begin = time.thread_time()
            run.step()
            seconds[name].append(time.thread_time() - begin)
    reference = statistics.median(seconds["neo_hookean"])
    for name, run in runs.items():
        median = statistics.median(seconds[name])
        each = 1e9 * median / run.particles.count
        print(f"{name:40s} {each:7.0f} ns per particle and step, {median / reference:.2f} of neo_hookean")


if __name__ == "__main__":
    main()
