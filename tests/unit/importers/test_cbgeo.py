"""Parts of the reader of CB-Geo's input: grids, places of nodes, particles, stresses, functions, materials."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest
from commands import spoken
from outside.cbgeo import sources
from outside.cbgeo.sources import Benchmark, held, level_block, rows, sliding_block, uniaxial_traction

from mpmcli.core.errors import SceneError
from mpmcli.importers.base import Translation
from mpmcli.importers.cbgeo import translate
from mpmcli.importers.cbgeo.mesh import cover, read_grid
from mpmcli.importers.cbgeo.particles import gauss_points
from mpmcli.importers.cbgeo.reading import read_table


def translated(given: Benchmark, folder: Path) -> Translation:
    made = translate(given.write(folder), partial=False)
    assert not made.problems(partial=False)
    return made


def grid_of(text: str, folder: Path, d: int = 2):
    path = folder / "mesh.txt"
    path.write_text(text)
    return read_grid(read_table(path, "mesh.txt", (2, d, 3, 2**d)), d)


@pytest.mark.parametrize("d", [2, 3])
def test_regular_grids(d, tmp_path):
    grid = grid_of(sources.mesh([3, 2, 4][:d], 0.1), tmp_path, d)
    assert not grid.is_turned
    np.testing.assert_array_equal(grid.counts, [3, 2, 4][:d])
    np.testing.assert_array_equal(grid.upper, [0.3, 0.2, 0.4][:d])
    np.testing.assert_array_equal(grid.place(grid.nodes)[:4, 0], [0, 0.1, 0.2, 0.3])


@pytest.mark.parametrize("angle", [-30.0, 12.5, 44.0])
def test_turned_grids(angle, tmp_path):
    grid = grid_of(sources.mesh([4, 3], 0.25, angle), tmp_path)
    assert grid.angle == angle
    np.testing.assert_allclose(grid.lower, 0, atol=1e-9)
    np.testing.assert_array_equal(grid.upper, [1, 0.75])


def test_turned_grids_in_3d(tmp_path):
    text = sources.mesh([2, 3, 1], 0.5)
    head, *lines = text.splitlines()[1:]
    turn = np.eye(3)
    turn[1:, 1:] = sources.rotation(25.0)
    nodes = np.array([[float(word) for word in line.split()] for line in lines[:24]]) @ turn.T
    grid = grid_of(f"{head}\n{rows(nodes)}" + "\n".join(lines[24:]), tmp_path, 3)
    assert grid.is_turned
    np.testing.assert_allclose(grid.axes, turn, atol=1e-9)
    np.testing.assert_allclose(grid.inside(turn @ [1.0, 2.0, 3.0]), [1, 2, 3], atol=1e-9)


def test_graded_grids_are_refused(tmp_path):
    x = [0, 0.1, 0.2, 0.4]
    nodes = [(a, b) for b in (0, 0.1) for a in x]
    cells = [(i, i + 1, i + 5, i + 4) for i in range(3)]
    with pytest.raises(SceneError, match=r"no regular grid: its cells are 0.1 to 0.2 long along x"):
        grid_of(f"8 3\n{rows(nodes)}{rows(cells)}", tmp_path)


@pytest.mark.parametrize("seed", range(5))
def test_boxes_cover_each_index_once(seed):
    random = np.random.default_rng(seed)
    chosen = np.unique(random.integers(0, 5, (40, 3)), axis=0)
    found = [
        index
        for low, high in cover(chosen)
        for index in itertools.product(*(range(a, b + 1) for a, b in zip(low, high, strict=True)))
    ]
    assert sorted(found) == sorted(map(tuple, chosen.tolist()))
    assert len(cover(np.array(list(itertools.product(range(3), range(4)))))) == 1


def test_a_turned_mesh_turns_gravity_and_particles(tmp_path):
    scene = translate(sliding_block().write(tmp_path), partial=True).scene
    assert scene["constants"]["turn"] == -30
    assert scene["loads"][0]["acceleration"] == ["-g*sin(turn*pi/180)", "-g*cos(turn*pi/180)"]
    assert scene["bodies"][0]["region"] == {"kind": "box", "lower": [2, 0], "upper": [3, 1]}
    assert scene["boundary"][-1] == {
        "name": "bottom",
        "kind": "velocity",
        "on": {"plane": {"axis": "y", "at": 0}},
        "direction": "y",
        "value": 0,
        "friction": 0.1,
    }


@pytest.mark.parametrize("upper", [False, True])
def test_friction_on_part_of_a_side(upper, tmp_path):
    """In a box, the direction points into the body; files and sets say the same."""
    given = level_block(friction=False)
    conditions = given.main["mesh"]["boundary_conditions"]
    row = 6 * 21 if upper else 0
    conditions["velocity_constraints"] = [{"file": "velocity-constraints.txt"}]
    conditions["friction_constraints"] = [{"file": "friction.txt"}]
    given.files["velocity-constraints.txt"] = rows((row + n, 1, 0.5) for n in range(10))
    given.files["friction.txt"] = rows((row + n, 1, 1 if upper else -1, 0.3) for n in range(4, 10))
    made = translated(given, tmp_path)
    smooth, rough = made.scene["boundary"]
    assert (smooth["direction"], smooth["value"]) == ("y", 0.5)
    assert rough["on"]["box"]["lower"][0] == 1.0
    assert rough["friction"] == 0.3
    assert (rough["direction"], rough["value"]) == (([0, -1], -0.5) if upper else ("y", 0.5))


def test_friction_from_the_wrong_side_is_refused(tmp_path):
    given = sliding_block()
    given.main["mesh"]["boundary_conditions"]["friction_constraints"][0]["sign_n"] = 1
    found = translate(given.write(tmp_path), partial=False).problems(partial=False)
    assert "points into the mesh" in str(found[0])


def test_nodes_with_axes_of_their_own(tmp_path):
    given = level_block(friction=False)
    given.main["mesh"]["boundary_conditions"]["nodal_euler_angles"] = "angles.txt"
    given.files["angles.txt"] = rows((n, np.pi / 6, 0) for n in range(21))
    boundary = translated(given, tmp_path).scene["boundary"]
    oblique = next(c for c in boundary if c["name"] == "bottom oblique")
    np.testing.assert_allclose(oblique["direction"], [-0.5, 0.75**0.5], atol=1e-9)


def test_the_first_constraint_of_a_node_holds(tmp_path):
    given = uniaxial_traction()
    given.main["mesh"]["boundary_conditions"]["velocity_constraints"] = [held(1, 0), held(1, 0, 0.5)]
    made = translated(given, tmp_path)
    assert [condition["name"] for condition in made.scene["boundary"]] == ["left"]
    assert "2 nodes that an earlier constraint holds" in str(made.of_kind("changed"))


@pytest.mark.parametrize(
    ("x", "f", "value"),
    [
        ([0, 1], [2, 2], -20.0),
        ([0, 0.5, 1], [0, 1, 1], "-10*ramp(t, 0, 0.5)"),
        ([0, 0.5, 1, 2], [0, 1, 0.5, 0.5], "-10*interpolate(t, 0, 0, 0.5, 1, 1, 0.5)"),
        (list(range(10)), [0, 1] * 5, '-10*interpolate(t, "function_0.csv")'),
    ],
)
def test_functions_of_time(x, f, value, tmp_path):
    given = uniaxial_traction()
    given.main["math_functions"][0] |= {"xvalues": x, "fxvalues": f}
    given.main["external_loading_conditions"]["particle_surface_traction"][0]["traction"] = -10
    made = translated(given, tmp_path)
    assert made.scene["loads"][0]["traction"] == [value, 0]
    if "csv" in str(value):
        assert made.files["function_0.csv"].splitlines()[:3] == ["t,value", "0,0", "1,1"]


def test_a_sine(tmp_path):
    given = uniaxial_traction()
    given.main["math_functions"] = [{"id": 0, "type": "Sin", "x0": 0.25, "a": 10, "xrange": [0, 1]}]
    load = translated(given, tmp_path).scene["loads"][0]
    assert load["traction"][0] == "sin(10*(t - 0.25))*(t >= 0)*(t <= 1)"


def test_tractions_of_other_particles_are_forces(tmp_path):
    given = uniaxial_traction()
    given.files["entity_sets.json"] = sources.sets([[3, 7], [0, 4]], [[4, 5]])
    load = translated(given, tmp_path).scene["loads"][0]
    assert (load["kind"], load["per"]) == ("particle_force", "particle")
    assert load["force"] == ["0.05*ramp(t, 0, 0.5)", 0]
    low, high = load["on"]["box"]["lower"], load["on"]["box"]["upper"]
    assert low[0] < 0.225 < 0.275 < high[0]
    assert high[1] < 0.075


def test_particles_of_scattered_sets_are_in_a_file(tmp_path):
    given = uniaxial_traction()
    given.files["entity_sets.json"] = sources.sets([[3, 7], [0, 4]], [[0, 5, 9]])
    made = translated(given, tmp_path)
    assert made.scene["loads"][0]["on"]["region"]["file"] == "traction.csv"
    assert len(made.files["traction.csv"].splitlines()) == 4


def test_particles_that_fill_no_cells_evenly_are_in_a_file(tmp_path):
    given = uniaxial_traction()
    given.files["particles.txt"] = "3\n0.025 0.025\n0.05 0.05\n0.2 0.07\n"
    given.files["entity_sets.json"] = sources.sets([[3, 7], [0, 4]], [[2]])
    made = translated(given, tmp_path)
    assert made.scene["bodies"][0]["region"] == {"kind": "points", "file": "body.csv"}
    assert made.files["body.csv"].splitlines() == [
        "x,y,volume",
        "0.025,0.025,0.005",
        "0.05,0.05,0.005",
        "0.2,0.07,0.01",
    ]


def test_gauss_points_of_a_file(tmp_path):
    given = uniaxial_traction()
    x = [(0.1 * (i + a), 0.1 * b) for i in range(3) for a in gauss_points(2) for b in gauss_points(2)]
    given.files["particles.txt"] = sources.particles(np.array(x))
    given.files["entity_sets.json"] = sources.sets([[3, 7], [0, 4]], [[10, 11]])
    made = translated(given, tmp_path)
    assert made.scene["bodies"][0]["particles_per_axis"] == 2
    assert "not at Gauss points" in str(made.of_kind("changed"))
    assert made.scene["loads"][0]["kind"] == "traction"


def test_materials_by_sets_make_bodies(tmp_path):
    given = uniaxial_traction()
    given.main["materials"].append(given.main["materials"][0] | {"id": 1, "youngs_modulus": 5e5})
    given.main["mesh"]["update_materials"] = True
    given.main["material_sets"] = [{"material_id": 1, "pset_id": 1}]
    given.files["entity_sets.json"] = sources.sets([[3, 7], [0, 4]], [[5, 11], [0, 1, 6, 7]])
    scene = translated(given, tmp_path).scene
    assert [(b["name"], b["material"], b["region"]["upper"]) for b in scene["bodies"]] == [
        ("body 1", "elastic", [0.3, 0.1]),
        ("body 2", "elastic 2", [0.1, 0.1]),
    ]


@pytest.mark.parametrize(
    ("stress", "expected"),
    [
        (lambda x, y: [0, -100, 0, 0, 0, 0], {"yy": -100}),
        (lambda x, y: [0, 200 * y - 20, 0, 3, 0, 0], {"yy": "-20 + 200*y", "xy": 3}),
        (lambda x, y: [-50 * x, 0, 0, 0, 0, 0], {"xx": "-50*x"}),
    ],
)
def test_stress_at_the_start(stress, expected, tmp_path):
    given = uniaxial_traction()
    x = sources.block([0, 0], [6, 2], 0.05)
    given.main["mesh"]["particles_stresses"] = "stresses.txt"
    given.files["stresses.txt"] = "12\n" + rows(stress(*row) for row in x)
    body = translated(given, tmp_path).scene["bodies"][0]
    assert body["stress"] == {"kind": "components"} | expected


def test_stress_that_is_not_linear_is_refused(tmp_path):
    given = uniaxial_traction()
    given.main["mesh"]["particles_stresses"] = "stresses.txt"
    given.files["stresses.txt"] = "12\n" + rows([i * i, 0, 0, 0, 0, 0] for i in range(12))
    made = translate(given.write(tmp_path), partial=False)
    assert "neither constant nor linear" in str(made.problems(partial=False)[0])


def test_local_damping(tmp_path):
    given = uniaxial_traction()
    given.main["analysis"]["damping"] = {"type": "Cundall", "damping_factor": 0.05}
    assert translated(given, tmp_path).scene["method"]["damping"] == {"local": 0.05}


def test_other_damping_and_contact_are_refused(tmp_path):
    given = level_block()
    given.main["analysis"] |= {"damping": {"type": "Viscous", "damping_factor": 1e3}, "interface": True}
    problems = list(map(str, translate(given.write(tmp_path / "a"), partial=False).problems(partial=False)))
    assert len(problems) == 2
    assert "damping of type 'Viscous'" in problems[0]
    assert "contact between materials" in problems[1]
    given.main["analysis"] |= {"damping": {"type": "Cundall", "damping_factor": 1}, "interface": False}
    made = translate(given.write(tmp_path / "b"), partial=False)
    assert [str(problem) for problem in made.problems(partial=False) if "below 1 is needed" in str(problem)]
    assert any("interface: switched off" in str(note) for note in made.of_kind("ignored"))


def test_the_flow_of_mohr_coulomb_is_noted(tmp_path):
    notes = translated(sources.mohr_coulomb_compression(), tmp_path).of_kind("changed")
    assert any("CB-Geo's potential is smooth" in str(note) for note in notes)


MATERIALS = {
    "Bingham2D": {"youngs_modulus": 1e6, "poisson_ratio": 0.4, "tau0": 100, "mu": 2, "critical_shear_rate": 0.1},
    "ModifiedCamClay2D": {
        "youngs_modulus": 1e6, "poisson_ratio": 0.25, "e_ref": 1.12, "p_ref": 1e5, "pc0": 3e5, "ocr": 1.5,
        "m": 1.2, "lambda": 0.1, "kappa": 0.03, "three_invariants": False, "subloading": False, "bonding": False,
    },
    "MohrCoulomb2D": {
        "youngs_modulus": 1e6, "poisson_ratio": 0.3, "softening": True, "friction": 30, "dilation": 5,
        "cohesion": 1000, "residual_friction": 20, "residual_dilation": 0, "residual_cohesion": 500,
        "peak_pdstrain": 0.01, "residual_pdstrain": 0.1, "tension_cutoff": 100,
    },
    "Newtonian2D": {"bulk_modulus": 1e6, "dynamic_viscosity": 0.5},
}  # fmt: skip


@pytest.mark.parametrize("kind", MATERIALS)
def test_materials_become_valid_ones(kind, tmp_path):
    given = uniaxial_traction()
    given.main["materials"] = [{"id": 0, "type": kind, "density": 1800.0, **MATERIALS[kind]}]
    code, written, _ = spoken(["import", "cbgeo", str(given.write(tmp_path))])
    assert code == 0, written
    assert "error" not in written


def test_faults_of_the_scene_stand_at_lines_of_the_source(tmp_path):
    given = uniaxial_traction()
    given.main["materials"] = [
        {"id": 0, "type": "Newtonian2D", "density": 1.0, "bulk_modulus": 1e300, "dynamic_viscosity": 0}
    ]
    source = given.write(tmp_path)
    lines = source.read_text().splitlines()
    line = next(number for number, text in enumerate(lines, 1) if '"type": "Newtonian2D"' in text) - 2
    code, written, _ = spoken(["import", "cbgeo", str(source), "-o", str(tmp_path / "x.yaml")])
    assert code == 3, written
    assert re.search(rf"mpm\.json:{line} +materials\.fluid.*\(.*x\.yaml, line \d+\)", written), written


def test_softening_soil(tmp_path):
    given = uniaxial_traction()
    given.main["materials"] = [
        {"id": 0, "type": "MohrCoulomb2D", "density": 1800.0, **MATERIALS["MohrCoulomb2D"]}
    ]
    soil = translated(given, tmp_path).scene["materials"]["soil"]
    assert soil == {
        "kind": "mohr_coulomb", "density": 1800, "E": 1e6, "nu": 0.3, "cohesion": 1000, "friction": 30,
        "dilation": 5, "tension": 100, "residual_cohesion": 500, "residual_friction": 20,
        "residual_dilation": 0, "softening_start": 0.01, "softening_end": 0.1,
    }  # fmt: skip


def test_two_phases_are_refused(tmp_path):
    given = uniaxial_traction()
    given.main["mesh"]["node_type"] = "N2D2P"
    given.main["particles"][0]["generator"] |= {"particle_type": "P2D2PHASE", "material_id": [0, 1]}
    found = [
        str(problem) for problem in translate(given.write(tmp_path), partial=False).problems(partial=False)
    ]
    assert [
        sum(word in line for line in found) for word in ("node_type", "particle_type", "material_id")
    ] == [1, 1, 1]


def test_cells_of_gimp(tmp_path):
    """Sixteen nodes for each cell that is surrounded by others."""
    given = uniaxial_traction()
    nodes = sources.lattice([6, 4])
    number = {tuple(index): i for i, index in enumerate(nodes.tolist())}
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    around = [(a, b) for b in range(-1, 3) for a in range(-1, 3) if (a, b) not in square]
    cells = [[number[i + a, 1 + b] for a, b in square + around] for i in (1, 2, 3)]
    given.files["mesh.txt"] = f"24 3\n{rows(nodes * 0.1 - 0.1)}{rows(cells)}"
    given.files["entity_sets.json"] = sources.sets([[10, 16], [7, 13]], [[5, 11]])
    given.main["mesh"]["cell_type"] = "ED2Q16G"
    scene = translated(given, tmp_path).scene
    assert scene["method"]["shape"] == "ugimp"
    assert scene["grid"] == {"lower": [-0.1, -0.1], "upper": [0.4, 0.2], "cell": 0.1}


def test_cam_clay_begins_at_its_pressure(tmp_path):
    """e0 = e_ref − λ ln(pc0/(ocr p_ref)) − κ ln(ocr)."""
    given = uniaxial_traction()
    numbers = MATERIALS["ModifiedCamClay2D"]
    given.main["materials"] = [{"id": 0, "type": "ModifiedCamClay2D", "density": 1800.0, **numbers}]
    clay = translated(given, tmp_path).scene["materials"]["clay"]
    assert clay["e0"] == pytest.approx(1.12 - 0.1 * np.log(2.0) - 0.03 * np.log(1.5))
    assert clay["pressure"] == pytest.approx(2e5)
    given.main["materials"][0] |= {"subloading_u": 10.0, "s_h": 0.1, "m_shear": 0.0}
    made = translated(given, tmp_path / "off")
    assert made.scene["materials"]["clay"] == clay
    assert "s_h: bonding is switched off" in "\n".join(map(str, made.of_kind("ignored")))
    given.main["materials"][0]["bonding"] = True
    found = translate(given.write(tmp_path), partial=False).problems(partial=False)
    assert [problem.path for problem in found] == ["materials.0.bonding"]


def test_quantities_of_the_archive(tmp_path):
    given = uniaxial_traction()
    given.main["post_processing"] |= {
        "vtk": ["stresses", "geometry", "strains"],
        "vtk_statevars": ["pdstrain", "x"],
    }
    made = translated(given, tmp_path / "elastic")
    assert made.scene["archive"]["particles"]["fields"][4:] == ["strain"]
    soil = {"id": 0, "type": "MohrCoulomb2D", "density": 1800.0, **MATERIALS["MohrCoulomb2D"]}
    given.main["materials"] = [soil]
    made = translated(given, tmp_path)
    fields = made.scene["archive"]["particles"]["fields"]
    assert fields[:4] == ["displacement", "velocity", "stress", "deformation_gradient"]
    assert fields[4:] == ["strain", "equivalent_plastic_strain"]
    assert "'x' is no quantity" in str(made.of_kind("ignored"))
    by_phase = [{"phase_id": 0, "statevars": ["pdstrain", "x"]}, {"phase_id": 1, "statevars": ["pressure"]}]
    given.main["post_processing"]["vtk_statevars"] = by_phase
    made = translated(given, tmp_path / "phases")
    assert made.scene["archive"]["particles"]["fields"] == fields
    notes = "\n".join(map(str, made.of_kind("ignored")))
    assert "'x' is no quantity" in notes
    assert "the phase 1; there is one phase" in notes


def test_forces_on_nodes(tmp_path):
    made = translated(sources.uniaxial_traction("nodes"), tmp_path).scene["loads"]
    assert [load["at"] for load in made] == [[0.3, 0], [0.3, 0.1]]
    assert made[0]["force"] == ["0.05*ramp(t, 0, 0.5)", 0]
    given = sources.uniaxial_traction("file")
    given.files["nodal-forces.txt"] = "3 0 0.05\n3 1 2\n7 0 0.05\n"
    made = translated(given, tmp_path / "file").scene["loads"]
    assert [load["force"] for load in made] == [[0.05, 2], [0.05, 0]]


def test_an_absorbing_side(tmp_path):
    given = sources.absorbing_column(10)
    for constraint in given.main["mesh"]["boundary_conditions"]["absorbing_constraints"]:
        constraint["a"] = 0.5
    _, dashpots, springs = translated(given, tmp_path).scene["loads"]
    assert dashpots["on"] == {"body": "body", "face": {"axis": "y", "side": "lower"}}
    assert dashpots["pressure_wave"] == pytest.approx(0.5 * np.sqrt(1e5 / 1800))
    assert dashpots["shear_wave"] == pytest.approx(np.sqrt(0.5e5 / 1800))
    assert springs["traction"] == [0, "-1e6*y"]
    assert springs["coordinates"] == "current"


def test_absorbing_nodes_of_several_sides(tmp_path):
    given = sources.absorbing_column(10)
    conditions = given.main["mesh"]["boundary_conditions"]
    both = {"nset_id": 0, "dir": 0, "delta": 0.1, "a": 1.0, "b": 1.0}
    conditions["absorbing_constraints"] = [both]
    loads = translated(given, tmp_path / "both").scene["loads"]
    sides = [load["on"]["face"]["side"] for load in loads if load["kind"] == "absorbing"]
    assert sides == ["lower", "upper"]
    conditions["absorbing_constraints"] = [both | {"dir": 1}]
    made = translate(given.write(tmp_path / "across"), partial=False)
    assert "no whole side of the mesh" in str(made.problems(partial=False)[0])


def test_functions_that_nothing_depends_on_or_with_the_same_number(tmp_path):
    given = uniaxial_traction()
    [function] = given.main["math_functions"]
    given.main["math_functions"] = [function, function | {"id": 3}]
    notes = [str(note) for note in translated(given, tmp_path / "unused").notes]
    assert any("nothing depends on the function 3" in note for note in notes)
    given.main["math_functions"] = [function, dict(function)]
    problems = translate(given.write(tmp_path / "twice"), partial=False).problems(partial=False)
    assert ["the function 0 is already defined" in str(problem) for problem in problems] == [True]


def test_signs_of_normals_are_one(tmp_path):
    """As in CB-Geo, which refuses others."""
    given = sliding_block()
    given.main["mesh"]["boundary_conditions"]["friction_constraints"][0]["sign_n"] = 0
    with pytest.raises(SceneError, match="sign_n"):
        translate(given.write(tmp_path / "key"), partial=False)
    given = level_block()
    path = given.write(tmp_path / "file")
    table = path.with_name("friction-constraints.txt")
    table.write_text(table.read_text().replace("-1\t", "-2\t", 1))
    problems = translate(path, partial=False).problems(partial=False)
    assert ["the sign of the normal is -1 or 1, not -2" in str(problem) for problem in problems] == [True]


def test_particles_of_other_dimensions_are_a_fault(tmp_path):
    given = level_block()
    given.main["particles"][0]["generator"] |= {"type": "file", "location": "p.txt", "io_type": "Ascii3D"}
    given.files["p.txt"] = "1\n0.5 0.5\n"
    problems = translate(given.write(tmp_path), partial=False).problems(partial=False)
    assert any("'Ascii3D' does not fit the 2D cells" in str(problem) for problem in problems)
