"""What scenes say about stress at the start."""

from types import SimpleNamespace

import numpy as np
import pytest

from mpmcli.boundary.buoyancy import Buoyancy
from mpmcli.boundary.gravity import Gravity
from mpmcli.core.errors import SceneError
from mpmcli.scene.filling import check_filling
from mpmcli.scene.initial_stress import Geostatic, start_stress
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {{kind: {analysis}}}
grid: {{lower: [0, 0], upper: [2, 3], cell: 0.5}}
materials:
  soil: {material}
bodies:
  - name: column
    material: soil
    region: {{kind: box, lower: [0, 0], upper: [2, 2]}}
    stress: {stress}
loads: {loads}
method: {{transfer: {{kind: flip}}}}
time: {{end: 1, courant: 0.4}}
"""
ELASTIC = "{kind: linear_elastic, E: 1000, nu: 0.25, density: 1}"
METAL = "{kind: j2_plastic, E: 1000, nu: 0.25, density: 1, hardening: {kind: linear, yield_stress: 0.1}}"
WEIGHT = "[{name: weight, kind: gravity, acceleration: [0, -10]}]"
WATER = "[{name: w, kind: buoyancy, level: 1, density: 1}]"
GEOSTATIC = "{kind: geostatic, K0: 0.5, surface: 2}"


@pytest.fixture
def checked(tmp_path):
    """Function that reads a scene and fills it."""

    def check(stress, analysis="plane_strain", material=ELASTIC, loads="[]"):
        path = tmp_path / "scene.yaml"
        path.write_text(SCENE.format(stress=stress, analysis=analysis, material=material, loads=loads))
        check_filling(load_scene(path).scene)

    return check


def test_geostatic_stress_below_a_water_table_is_that_of_the_buoyant_weight():
    body = SimpleNamespace(
        name="soil", material="soil", stress=Geostatic(kind="geostatic", K0=0.5, surface=4)
    )
    water = [
        Buoyancy(name="w", level="3 + x", density=0.4),
        Buoyancy(name="elsewhere", on={"body": "other"}, level=9, density=5),
    ]
    scene = SimpleNamespace(
        loads=[Gravity(name="g", acceleration=[0, -10])],
        loads_on=lambda quantity: water,
        materials={"soil": SimpleNamespace(density=2.0)},
        analysis=SimpleNamespace(kind="plane_strain"),
    )
    # dry, below the table, and where water stands over the ground
    stress, problems = start_stress(scene, body, np.array([[0.0, 0.0, 5.0], [3.5, 1.0, 1.0]]))
    assert not problems
    np.testing.assert_allclose(stress[1], [-10, -60 + 8, -60 + 12])
    np.testing.assert_allclose(stress[0], 0.5 * stress[1])


def test_stress_that_fits_is_accepted(checked):
    checked(GEOSTATIC, loads=WEIGHT)
    checked("{kind: components, xx: -x, yy: -3, zz: 1, xy: y/10}")
    checked("{kind: components, xx: 1}", "plane_stress")


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"stress": GEOSTATIC}, "needs gravity along one axis of the grid"),
        ({"stress": GEOSTATIC, "loads": WEIGHT, "analysis": "plane_stress"}, "K0 must be 0"),
        ({"stress": "null", "loads": WATER}, "loads.w.kind.*needs gravity along one axis"),
        ({"stress": "null", "loads": WATER.replace("1", "z", 1)}, "'z' does not exist"),
        ({"stress": "{kind: components, xz: 1}"}, "stress.xz .*does not exist in the analysis 'plane_strain'"),
        ({"stress": "{kind: components, zz: 1}", "analysis": "plane_stress"}, "is zero in the analysis 'plane_stress'"),
        ({"stress": "{kind: components, xx: z}"}, "'z' does not exist in this analysis"),
        ({"stress": "{kind: components, xx: 1/(x - 0.125)}"}, "not finite"),
        ({"stress": "{kind: components, xx: -1}", "material": METAL}, "cannot have this stress at rest: at .0.125"),
        ({"stress": "{kind: components, xx: -1}", "material": "{kind: tait_fluid, density: 1, K: 100}"}, "cannot have"),
        ({"stress": "{kind: components, xx: -1}", "material": "{kind: rigid}"}, "a rigid body has no stress"),
        ({"stress": "{kind: components, xx: -1e4}"}, "cannot have this stress"),
    ],
)  # fmt: skip
def test_stress_that_does_not_fit_is_refused_in_words(checked, keys, words):
    with pytest.raises(SceneError, match=words):
        checked(**keys)


POINTS = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [2, 3], cell: 1}}
materials: {{soil: {{kind: linear_elastic, E: 1000, nu: 0.25, density: 1}}}}
bodies:
  - {{name: column, material: soil, region: {region}, stress: {{kind: points}}}}
method: {{transfer: {{kind: flip}}}}
time: {{end: 1, courant: 0.4}}
"""
TABLE = "x,y,volume,stress_yy,stress_xy\n1.25,1.75,0.25,-3,0.1\n0.25,0.25,0.25,-1,0\n0.75,0.25,0.25,-2,0.2\n"


def with_points(folder, table=TABLE, region="{kind: points, file: points.csv}"):
    (folder / "points.csv").write_text(table)
    (folder / "scene.yaml").write_text(POINTS.format(region=region))
    loaded = load_scene(folder / "scene.yaml")
    check_filling(loaded.scene)
    return Simulation(loaded)


@pytest.mark.slow
def test_stress_of_each_particle_comes_from_the_file_of_points(tmp_path):
    particles = with_points(tmp_path).particles
    stress = particles.tau / particles.determinant()
    at = {tuple(X): (yy, xy) for X, yy, xy in zip(particles.X.T.tolist(), stress[1], stress[3], strict=True)}
    assert at[1.25, 1.75] == pytest.approx((-3, 0.1))
    assert at[0.25, 0.25] == pytest.approx((-1, 0))
    assert at[0.75, 0.25] == pytest.approx((-2, 0.2))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"table": "x,y,volume\n1,1,0.25\n"}, "'points.csv' has no column stress_xx"),
        ({"table": "x,y,volume,stress_xz\n1,1,0.25,1\n"}, "stress_xz does not exist in the analysis"),
        ({"table": "x,y,volume,stress_xx\n1,1,0.25,nan\n"}, "not all finite"),
        ({"region": "{kind: box, lower: [0, 0], upper: [1, 1]}"}, "needs a region of kind points"),
    ],
)
def test_files_without_stress_are_refused_in_words(tmp_path, keys, words):
    with pytest.raises(SceneError, match=words):
        with_points(tmp_path, **keys)


STRAIN = "{kind: strain, xx: 0.01, yy: -0.004, xy: 0.006}"


@pytest.mark.parametrize(
    "material", [ELASTIC, METAL.replace("0.1}", "1e6}"), ELASTIC.replace("linear_elastic", "neo_hookean")]
)
def test_strain_at_the_start_is_what_bodies_have(tmp_path, material):
    """Its stress is that of the material, and its energy is stored; plastic bodies keep F at the identity."""
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.format(stress=STRAIN, analysis="plane_strain", material=material, loads="[]"))
    simulation = Simulation(load_scene(path))
    particles = simulation.particles
    sigma = particles.tau / particles.determinant()
    if "neo" not in material:  # Hencky elasticity
        lame, shear, J = 400.0, 400.0, np.exp(0.006) if "linear" in material.split(",")[0] else 1.0
        exact = (
            np.array([lame * 0.006 + 2 * shear * e for e in (0.01, -0.004, 0.0)] + [2 * shear * 0.006]) / J
        )
        np.testing.assert_allclose(sigma, np.tile(exact[:, None], sigma.shape[1]), rtol=1e-9)
    if "j2" not in material:
        F = particles.F
        V = np.array([[F[0, 0], F[1, 0]], [F[2, 0], F[3, 0]]])
        values, vectors = np.linalg.eigh(V)
        np.testing.assert_allclose(
            vectors @ np.diag(np.log(values)) @ vectors.T, [[0.01, 0.006], [0.006, -0.004]], atol=1e-12
        )
    np.testing.assert_allclose(particles.mass.sum(), 4.0, rtol=1e-12)
    assert simulation.stress.energy_density().min() > 0.0


@pytest.mark.parametrize(
    ("stress", "analysis", "material", "words"),
    [
        (STRAIN, "plane_strain", METAL, "cannot have this elastic strain at rest: .* beyond yielding"),
        (STRAIN, "plane_strain", "{kind: tait_fluid, K: 10, density: 1}", "a shear strain in a fluid"),
        (
            STRAIN,
            "plane_stress",
            ELASTIC,
            "the strain zz follows from the others in the analysis 'plane_stress'",
        ),
        ("{kind: strain, yz: 0.1}", "plane_strain", ELASTIC, "this component does not exist"),
        ("{kind: strain, xx: 1/(x-0.125)}", "plane_strain", ELASTIC, "is not finite at some particles"),
    ],
)
def test_strains_that_no_body_can_have(checked, stress, analysis, material, words):
    with pytest.raises(SceneError, match=words):
        checked(stress, analysis, material)
