"""Inputs of CB-Geo's public benchmarks, written from their published numbers.

cb-geo/mpm (MIT) keeps its benchmarks in cb-geo/mpm-benchmarks, which states no licence. The files are therefore not
copied: this module writes inputs in the program's format with the same grids, particles, sets, materials, conditions,
loads, steps and keys. ``BENCHMARKS`` names the folder of each.
"""

import itertools
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np


@dataclass
class Benchmark:
    """One input: what its files say."""

    folder: str
    main: dict[str, Any]
    files: dict[str, str] = field(default_factory=dict)

    def write(self, path: Path) -> Path:
        """Write all files into a folder; the path of the main one."""
        path.mkdir(parents=True, exist_ok=True)
        for name, text in self.files.items():
            (path / name).write_text(text)
        main = path / "mpm.json"
        main.write_text(json.dumps(self.main, indent=2) + "\n")
        return main


def lattice(counts: Sequence[int]) -> np.ndarray:
    """Indices (n, d) of a box, the first axis fastest."""
    return np.array([index[::-1] for index in itertools.product(*map(range, reversed(counts)))])


def rows(values: Any) -> str:
    """Lines of numbers."""
    return "".join("\t".join(f"{v:.12g}" for v in row) + "\n" for row in values)


def mesh(counts: Sequence[int], cell: float, turn: float = 0.0) -> str:
    """The text of a mesh file, turned by degrees about the origin."""
    nodes = lattice([n + 1 for n in counts])
    x = nodes * cell
    if turn:
        x = x @ rotation(turn).T
    strides = np.cumprod([1, *[n + 1 for n in counts]])[:-1]
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = square if len(counts) == 2 else [(*c, k) for k in (0, 1) for c in square]
    cells = [[int((np.array(c) + low) @ strides) for c in corners] for low in lattice(counts)]
    return f"! cells of {cell:g}\n{len(x)}\t{len(cells)}\n" + rows(x) + rows(cells)


def rotation(degrees: float) -> np.ndarray:
    """The matrix of a turn."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


def block(lower: Sequence[float], counts: Sequence[int], spacing: float) -> np.ndarray:
    """Particles (n, d) at the middles of squares or cubes from a corner on, the first axis fastest."""
    return np.array(lower) + (lattice(counts) + 0.5) * spacing


def particles(x: np.ndarray) -> str:
    """The text of a file of particles."""
    return f"{len(x)}\n" + rows(x)


def side(counts: Sequence[int], axis: int, upper: bool) -> list[int]:
    """Nodes of one side of a box."""
    nodes = lattice([n + 1 for n in counts])
    return np.flatnonzero(nodes[:, axis] == (counts[axis] if upper else 0)).tolist()


def sets(nodes: Sequence[Sequence[int]] = (), members: Sequence[Sequence[int]] = ()) -> str:
    """The text of a file of sets, numbered in their order."""
    made = {"node_sets": nodes, "particle_sets": members}
    return json.dumps(
        {key: [{"id": i, "set": list(s)} for i, s in enumerate(g)] for key, g in made.items() if g}
    )


def held(nset: int, axis: int, velocity: float = 0.0) -> dict[str, Any]:
    """A velocity constraint."""
    return {"nset_id": nset, "dir": axis, "velocity": velocity}


def main(d: int, title: str, material: dict[str, Any], **parts: Any) -> dict[str, Any]:
    """The main file: ``mesh``, ``conditions``, ``loading``, ``functions``, ``analysis``, ``output``, ``generator``."""
    generator = parts.get("generator") or {
        "check_duplicates": True,
        "location": "particles.txt",
        "io_type": f"Ascii{d}D",
        "pset_id": parts.get("pset_id", 99),
        "particle_type": f"P{d}D",
        "material_id": material["id"],
        "type": "file",
    }
    analysis = {"type": f"MPMExplicit{d}D", "uuid": "benchmark", "resume": {"resume": False, "step": 5}}
    made = {
        "title": title,
        "mesh": {
            "mesh": "mesh.txt",
            "entity_sets": "entity_sets.json",
            "cell_type": "ED2Q4" if d == 2 else "ED3H8",
            "isoparametric": False,
            "io_type": f"Ascii{d}D",
            "node_type": f"N{d}D",
            "boundary_conditions": parts.get("conditions", {}),
            **parts.get("mesh", {}),
        },
        "particles": [{"generator": generator}],
        "materials": [material],
        "external_loading_conditions": {"gravity": [0.0] * d, **parts.get("loading", {})},
        "math_functions": parts.get("functions", []),
        "analysis": analysis | parts["analysis"],
        "post_processing": {"path": "results/", "vtk": [], "vtk_statevars": [], **parts["output"]},
    }
    return {key: value for key, value in made.items() if value != []}


def elastic(d: int, density: float, modulus: float, poisson: float = 0.0) -> dict[str, Any]:
    """A linear elastic material."""
    return {
        "id": 0,
        "type": f"LinearElastic{d}D",
        "density": density,
        "youngs_modulus": modulus,
        "poisson_ratio": poisson,
    }


def uniaxial_traction(load: str = "particles") -> Benchmark:
    """A bar of three cells, held at its left end and pulled at its right one by 1 Pa within 0.5 s."""
    ramp = [{"id": 0, "type": "Linear", "xvalues": [0.0, 0.5, 1.0], "fxvalues": [0.0, 1.0, 1.0]}]
    loading: dict[str, Any] = {
        "particles": {
            "particle_surface_traction": [{"math_function_id": 0, "pset_id": 0, "dir": 0, "traction": 1}]
        },
        "nodes": {
            "concentrated_nodal_forces": [{"math_function_id": 0, "nset_id": 0, "dir": 0, "force": 0.05}]
        },
        "file": {"concentrated_nodal_forces": [{"file": "nodal-forces.txt"}]},
    }[load]
    made = main(
        2,
        "uniaxial-traction",
        elastic(2, 1000.0, 1e6),
        conditions={"velocity_constraints": [held(1, 0)]},
        loading=loading,
        functions=ramp,
        analysis={"dt": 0.001, "nsteps": 1000, "velocity_update": True},
        output={"output_steps": 10},
    )
    files = {
        "mesh.txt": mesh([3, 1], 0.1),
        "particles.txt": particles(block([0, 0], [6, 2], 0.05)),
        "entity_sets.json": sets([[3, 7], [0, 4]], [[5, 11]]),
    }
    if load == "file":
        files["nodal-forces.txt"] = "3 0 0.05\n7 0 0.05\n"
    return Benchmark("2d/uniaxial_traction", made, files)


def uniaxial_stress(d: int = 2, update: str = "usf") -> Benchmark:
    """One cell of four (eight) particles, compressed by 1 % in ten steps."""
    made = main(
        d,
        "Element test",
        elastic(d, 1.0, 1000.0),
        conditions={"velocity_constraints": [held(0, 1), held(1, 1, -0.01)]},
        analysis={"dt": 0.01, "nsteps": 10, "stress_update": update},
        output={"output_steps": 1},
    )
    counts = [1] * d
    files = {
        "mesh.txt": mesh(counts, 1.0),
        "particles.txt": particles(block([0] * d, [2] * d, 0.5)),
        "entity_sets.json": sets([side(counts, 1, False), side(counts, 1, True)]),
    }
    return Benchmark(f"{d}d/uniaxial_stress", made, files)


def hydrostatic_column(material: str = "elastic", update: str = "usl") -> Benchmark:
    """A column 0.2 m wide and 0.1 m high, 25 particles per cell, that settles under gravity."""
    fluid = {"id": 0, "type": "Newtonian2D", "density": 1800, "bulk_modulus": 1e6, "dynamic_viscosity": 0}
    counts = [20, 12]
    left = [n for n in side(counts, 0, False) if n not in (231, 252)]  # as published
    made = main(
        2,
        "Hydrostatic column",
        elastic(2, 1800.0, 1e6) if material == "elastic" else fluid,
        conditions={"velocity_constraints": [held(0, 0), held(1, 1)]},
        loading={"gravity": [0, -9.81]},
        analysis={"dt": 1e-5, "nsteps": 20000, "stress_update": update, "velocity_update": True},
        output={"output_steps": 1000},
    )
    files = {
        "mesh.txt": mesh(counts, 0.01),
        "particles.txt": particles(block([0, 0], [100, 50], 0.002)),
        "entity_sets.json": sets([left + side(counts, 0, True), side(counts, 1, False)]),
    }
    return Benchmark("2d/hydrostatic_column/quad-mesh", made, files)


def hydrostatic_column_3d() -> Benchmark:
    """The same in three dimensions, with particles at Gauss points of all cells."""
    counts = [4, 4, 10]
    generator = {
        "check_duplicates": True,
        "particle_type": "P3D",
        "cset_id": -1,
        "material_id": 0,
        "nparticles_per_dir": 2,
        "type": "gauss",
    }
    made = main(
        3,
        "Hydrostatic column",
        elastic(3, 1800.0, 1e6),
        conditions={"velocity_constraints": [{"file": "velocity-constraints.txt"}]},
        loading={"gravity": [0, 0, -9.81]},
        generator=generator,
        analysis={"dt": 1e-5, "nsteps": 10000, "stress_update": "usl", "velocity_update": True},
        output={"output_steps": 1000},
    )
    constraints = [(n, a, 0) for a in (0, 1) for up in (False, True) for n in side(counts, a, up)]
    constraints += [(n, 2, 0) for n in side(counts, 2, False)]
    del made["mesh"]["entity_sets"]
    files = {"mesh.txt": mesh(counts, 0.01), "velocity-constraints.txt": rows(constraints)}
    return Benchmark("3d/hydrostatic_column", made, files)


def mohr_coulomb_compression() -> Benchmark:
    """A block of cohesive soil between its rough base and a plate that moves down: unconfined compression."""
    soil = {
        "id": 0,
        "type": "MohrCoulomb2D",
        "density": 10,
        "youngs_modulus": 1e7,
        "poisson_ratio": 0.2,
        "friction": 0,
        "dilation": 0,
        "cohesion": 250,
        "residual_friction": 0,
        "residual_dilation": 0,
        "residual_cohesion": 250,
        "peak_epds": 2000,
        "critical_epds": 5000,
        "tension_cutoff": 1000,
        "porosity": 0.3,
    }
    made = main(
        2,
        "Unconfined Compression Test",
        soil,
        conditions={"velocity_constraints": [{"file": "velocity-constraints.txt"}]},
        analysis={"dt": 1e-6, "nsteps": 5000, "stress_update": "usf", "velocity_update": True},
        output={"output_steps": 10, "vtk": ["stresses", "velocities", "strains"]},
    )
    del made["mesh"]["entity_sets"]
    counts = [6, 10]
    constraints = [(n, 0, 0) for n in side(counts, 0, False)]
    constraints += [(n, 1, 0) for n in side(counts, 1, False)]
    constraints += [(n, 1, -0.002) for n in side(counts, 1, True)]
    files = {
        "mesh.txt": mesh(counts, 0.005),
        "particles.txt": particles(block([0, 0], [20, 40], 0.00125)),
        "velocity-constraints.txt": rows(constraints),
    }
    return Benchmark("2d/mc_uniaxial_compression", made, files)


def sliding_block() -> Benchmark:
    """A block on a plane inclined by 30°, with friction 0.1, in a mesh that is turned with the plane."""
    counts, slope = [20, 6], -30.0
    both = side(counts, 0, False) + side(counts, 0, True)
    made = main(
        2,
        "2D Boundary Test with Velocity and Friction",
        elastic(2, 1800.0, 1e10),
        mesh={"isoparametric": True},
        conditions={
            "velocity_constraints": [held(0, 0), held(1, 1)],
            "friction_constraints": [{"nset_id": 1, "dir": 1, "sign_n": -1, "friction": 0.1}],
            "nodal_euler_angles": "nodal-euler-angles.txt",
        },
        loading={"gravity": [0, -9.81]},
        analysis={"dt": 1e-5, "nsteps": 100000, "stress_update": "usf", "velocity_update": True},
        output={"output_steps": 1000},
    )
    x = block([2, 0], [16, 16], 0.0625) @ rotation(slope).T
    nodes = 21 * 7
    files = {
        "mesh.txt": mesh(counts, 0.25, slope),
        "particles.txt": particles(x),
        "entity_sets.json": sets([both, side(counts, 1, False)]),
        "nodal-euler-angles.txt": rows((n, np.radians(slope), 0) for n in range(nodes)),
    }
    return Benchmark("2d/sliding_block_inclined_boundary", made, files)


def level_block(friction: bool = True) -> Benchmark:
    """The same block on a level plane, with gravity turned instead, and stresses at the start."""
    counts = [20, 6]
    conditions: dict[str, Any] = {"velocity_constraints": [{"file": "velocity-constraints.txt"}]}
    files = {
        "mesh.txt": mesh(counts, 0.25),
        "particles.txt": particles(block([2, 0], [16, 16], 0.0625)),
        "velocity-constraints.txt": rows(
            [(n, 0, 0) for up in (False, True) for n in side(counts, 0, up)]
            + [(n, 1, 0) for n in side(counts, 1, False)]
        ),
    }
    if friction:
        conditions["friction_constraints"] = [{"file": "friction-constraints.txt"}]
        files["friction-constraints.txt"] = rows((n, 1, -1, 0.1) for n in side(counts, 1, False))
    made = main(
        2,
        "2D Boundary Test with Velocity and Friction",
        elastic(2, 1800.0, 1e10),
        mesh={"isoparametric": True},
        conditions=conditions,
        loading={"gravity": [4.905, -8.496]},
        analysis={"dt": 1e-5, "nsteps": 100000, "stress_update": "usf", "velocity_update": True},
        output={"output_steps": 1000},
    )
    del made["mesh"]["entity_sets"]
    return Benchmark("2d/boundary_level", made, files)


def absorbing_column(height: int = 100) -> Benchmark:
    """A column 6 cells wide on Kelvin-Voigt elements, loaded at its top by 100 Pa within 1 ms."""
    counts = [6, height]
    base = side(counts, 1, False)
    absorbing = {"dir": 1, "delta": 0.10, "h_min": 0.001, "a": 1.0, "b": 1.0}
    gauss = np.array([0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5])
    x = np.array(
        [
            [(i + a) * 1e-3, (j + b) * 1e-3]
            for j in range(height)
            for i in range(6)
            for b in gauss
            for a in gauss
        ]
    )
    top = np.flatnonzero(x[:, 1] > x[:, 1].max() - 1e-9).tolist()
    made = main(
        2,
        "Absorbing-Boundary",
        elastic(2, 1800.0, 100e3),
        conditions={
            "velocity_constraints": [held(0, 0)],
            "absorbing_constraints": [
                {"nset_id": 1, **absorbing, "position": "corner"},
                {"nset_id": 2, **absorbing, "position": "edge"},
            ],
        },
        loading={
            "particle_surface_traction": [{"pset_id": 0, "math_function_id": 0, "dir": 1, "traction": -100}]
        },
        functions=[{"id": 0, "type": "Linear", "xvalues": [0.0, 1e-3, 5.0], "fxvalues": [0.0, 1.0, 1.0]}],
        analysis={"dt": 1e-5, "nsteps": 30001, "stress_update": "usf", "velocity_update": False},
        output={"output_steps": 100, "vtk": ["stresses", "displacements"]},
    )
    sides = side(counts, 0, False) + side(counts, 0, True)
    files = {
        "mesh.txt": mesh(counts, 0.001),
        "particles.txt": particles(x),
        "entity_sets.json": sets([sides, [base[0], base[-1]], base[1:-1]], [top]),
    }
    return Benchmark("2d/uniaxial_absorbing", made, files)


def plate_with_hole(refined: int = 1) -> Benchmark:
    """A quarter of a plate with a hole of radius 0.5 m, 2.5 m high and 4 m long, pulled by 1 Pa.

    ``refined`` is 1 for cells of 0.0625 m as published; larger numbers make them larger by that factor.
    """
    h = 0.0625 * refined
    counts = [round(4 / h), round(2.5 / h)]
    x = block([0, 0], [4 * c for c in counts], h / 4)
    x = x[(x**2).sum(axis=1) > 0.25]
    end = np.flatnonzero(x[:, 0] > 4 - h / 4).tolist()
    made = main(
        2,
        "Plate with a hole",
        elastic(2, 2000.0, 1e6),
        mesh={"particles_volumes": "particles-volumes.txt"},
        conditions={"velocity_constraints": [held(0, 0), held(1, 1)]},
        loading={"particle_surface_traction": [{"pset_id": 0, "dir": 0, "traction": 1}]},
        analysis={"dt": 1e-4, "nsteps": 300000, "stress_update": "usf", "velocity_update": True},
        output={"output_steps": 1000},
    )
    hole = round(0.5 / h)
    left = [n for n in side(counts, 0, False) if n >= hole * (counts[0] + 1)]
    bottom = [n for n in side(counts, 1, False) if n >= hole]
    files = {
        "mesh.txt": mesh(counts, h),
        "particles.txt": particles(x),
        "particles-volumes.txt": rows((i, (h / 4) ** 2) for i in range(len(x))),
        "entity_sets.json": sets([left, bottom], [end]),
    }
    return Benchmark("2d/plate_with_hole/cartesian", made, files)


def dam_break(coarse: int = 1) -> Benchmark:
    """A column of water collapses in a box 0.456 m long and high, 0.228 m wide.

    ``coarse`` is 1 for cells of 0.0114 m as published; larger numbers make them larger by that factor.
    """
    h = 0.0114 * coarse
    counts = [40 // coarse, 20 // coarse, 40 // coarse]
    water = {"id": 0, "type": "Newtonian3D", "density": 1000.0, "bulk_modulus": 1e6, "dynamic_viscosity": 0.5}
    width = round(0.114 / h)
    made = main(
        3,
        "3D Dam break",
        water,
        mesh={"check_duplicates": True},
        conditions={"velocity_constraints": [held(0, 0), held(1, 1), held(2, 2)]},
        loading={"gravity": [0.0, 0.0, -9.814]},
        analysis={"dt": 1e-4, "nsteps": 20000, "stress_update": "usf"},
        output={"output_steps": 50},
    )
    walls = [side(counts, a, False) + side(counts, a, True) for a in (0, 1)]
    files = {
        "mesh.txt": mesh(counts, h),
        "particles.txt": particles(block([0, 0, 0], [2 * width, 2 * counts[1], 4 * width], h / 2)),
        "entity_sets.json": sets([*walls, side(counts, 2, False)]),
    }
    return Benchmark("3d/dam-break", made, files)


def moved_particles() -> Benchmark:
    """Particles at Gauss points of two cell sets that keep a velocity."""
    counts = [2, 2, 4]
    gauss = {"check_duplicates": False, "particle_type": "P3D", "material_id": 0, "nparticles_per_dir": 2}
    made = main(
        3,
        "Particle sets",
        elastic(3, 1800.0, 1e6),
        conditions={
            "particles_velocity_constraints": [
                {"pset_id": 0, "dir": 2, "velocity": 5.0},
                {"pset_id": 1, "dir": 2, "velocity": -5.0},
            ]
        },
        generator={"type": "gauss", "cset_id": 0, "pset_id": 0, **gauss},
        analysis={"dt": 1e-5, "nsteps": 500, "stress_analysis": "usl", "velocity_update": True},
        output={"output_steps": 10},
    )
    made["particles"].append({"generator": {"type": "gauss", "cset_id": 1, "pset_id": 1, **gauss}})
    cells = {"cell_sets": [{"id": 0, "set": [0, 1, 2, 3]}, {"id": 1, "set": [12, 13, 14, 15]}]}
    files = {"mesh.txt": mesh(counts, 0.1), "entity_sets.json": json.dumps(cells)}
    return Benchmark("3d/particle_sets_generations", made, files)


def injected_particles() -> Benchmark:
    """Particles that appear in a cell set between 10 and 20 ms."""
    made = moved_particles()
    made.folder = "3d/inject"
    del made.main["mesh"]["boundary_conditions"]["particles_velocity_constraints"]
    made.main["particles"] = [
        {
            "generator": {
                "check_duplicates": True,
                "particle_type": "P3D",
                "cset_id": 0,
                "material_id": 0,
                "nparticles_per_dir": 2,
                "velocity": [0.0, 0.0, -5.0],
                "duration": [0.01, 0.02],
                "type": "inject",
            }
        }
    ]
    return made


def consolidation() -> Benchmark:
    """Two phases: a porous column that drains."""
    made = uniaxial_traction()
    made.folder = "2d/consolidation"
    made.main["analysis"]["type"] = "MPMExplicitTwoPhase2D"
    conditions = made.main["mesh"]["boundary_conditions"]
    conditions["pore_pressure_constraints"] = [{"file": "pore-pressure-constraint.txt"}]
    return made


BENCHMARKS: dict[str, Callable[[], Benchmark]] = {
    "absorbing_column": absorbing_column,
    "consolidation": consolidation,
    "dam_break": dam_break,
    "hydrostatic_column": hydrostatic_column,
    "hydrostatic_column_3d": hydrostatic_column_3d,
    "hydrostatic_fluid": lambda: hydrostatic_column("fluid", "usf"),
    "injected_particles": injected_particles,
    "level_block": level_block,
    "level_block_frictionless": lambda: level_block(friction=False),
    "mohr_coulomb_compression": mohr_coulomb_compression,
    "moved_particles": moved_particles,
    "plate_with_hole": plate_with_hole,
    "sliding_block": sliding_block,
    "uniaxial_stress": uniaxial_stress,
    "uniaxial_stress_3d": lambda: uniaxial_stress(3),
    "uniaxial_stress_usl": lambda: uniaxial_stress(update="usl"),
    "uniaxial_traction": uniaxial_traction,
    "uniaxial_traction_file": lambda: uniaxial_traction("file"),
    "uniaxial_traction_nodes": lambda: uniaxial_traction("nodes"),
}
"""Every benchmark by name."""


if __name__ == "__main__":
    import sys

    for name, make in BENCHMARKS.items():
        print(make().write(Path(sys.argv[1]) / name))
