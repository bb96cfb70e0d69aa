"""Dashpots on grid planes: forces by area, impedance and velocity, and what scenes may not ask."""

import numpy as np
import pytest

from mpmcli.boundary.absorbing import Absorbing
from mpmcli.boundary.plane_dashpots import PlaneDashpots
from mpmcli.core.errors import SceneError
from mpmcli.core.grid import Grid
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [4, 4], cell: 1}
method: {shape: linear, transfer: {kind: flip}}
materials:
  soft: {kind: linear_elastic, E: 1, nu: 0, density: 1}
  hard: {kind: linear_elastic, E: 16, nu: 0, density: 4}
bodies:
  - {name: left, material: soft, region: {kind: box, lower: [0, 1], upper: [2, 3]}, velocity: [0, -0.01]}
  - {name: right, material: hard, region: {kind: box, lower: [2, 1], upper: [4, 3]}, velocity: [0.02, -0.01]}
loads:
  - {name: base, kind: absorbing, on: PLACE}
time: {end: 1, courant: 0.1}
"""
PLANE = "{plane: {axis: y, at: 1}}"


def test_nodes_give_their_share_of_each_material(plain_python):
    """Forces on the plane are ρ c_p V_n and ρ c_s V_t of the materials above it, in all the area 2 + 2."""
    with plain_python():
        s = Simulation(load_scene(SCENE.replace("PLACE", PLANE)))
        s.step()
    force = s.loads.force
    at = s.grid.coordinates(np.arange(s.grid.node_count))
    rows = {y: np.abs(at[1] - y) < 1e-9 for y in (0.0, 1.0, 2.0, 3.0)}
    assert np.count_nonzero(force[rows[2.0]]) == np.count_nonzero(force[rows[3.0]]) == 0
    # speeds 1 and 2 along the normal, half the square root of it across: impedances 1 and 8
    inner = rows[1.0] & (np.abs(at[0] - 1.0) < 1e-9)
    assert force[inner] == pytest.approx(np.array([[0.0, 0.01]]))
    inner = rows[1.0] & (np.abs(at[0] - 3.0) < 1e-9)
    assert force[inner] == pytest.approx(np.array([[-0.02 * 8 / np.sqrt(2), 0.08]]))
    assert force[:, 1].sum() == pytest.approx(0.01 * (2 * 1 + 2 * 8))


OWN = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [4, 4], cell: 1}
method: {shape: linear, transfer: {kind: flip}}
materials:
  m: {kind: linear_elastic, E: 1, nu: 0, density: 1}
bodies:
  - {name: b, material: m, region: {kind: points, file: p.csv}, velocity: ["where(x > 2, 0.02, 0)", -0.01]}
loads:
  - {name: base, kind: absorbing, on: PLACE}
time: {end: 1, courant: 0.1}
"""


@pytest.mark.parametrize(
    "place", [PLANE, "{body: BODY, face: {axis: y, side: lower}}"], ids=["plane", "face"]
)
def test_particles_have_the_impedance_of_their_own_numbers(plain_python, tmp_path, place):
    """Columns E and density of one body give the forces of two bodies with a material each."""
    points = [(0.25 + 0.5 * i, 1.25 + 0.5 * j) for i in range(8) for j in range(4)]
    rows = [f"{x},{y},0.25,{16 if x > 2 else 1},{4 if x > 2 else 1}" for x, y in points]
    (tmp_path / "p.csv").write_text("\n".join(["x,y,volume,E,density", *rows]) + "\n")
    (tmp_path / "scene.yaml").write_text(OWN.replace("PLACE", place.replace("BODY", "b")))
    two = SCENE.replace("PLACE", place.replace("BODY", "left"))
    if place != PLANE:
        other = "  - {name: other, kind: absorbing, on: {body: right, face: {axis: y, side: lower}}}\n"
        two = two.replace("time:", other + "time:")
    with plain_python():
        several = Simulation(load_scene(two))
        one = Simulation(load_scene(tmp_path / "scene.yaml"))
        several.step()
        one.step()
    assert np.abs(one.loads.force).max() > 0.05
    assert one.loads.force == pytest.approx(several.loads.force, abs=1e-15)
    assert one.time_step.courant == several.time_step.courant


def double(sums):
    sums *= 2.0


@pytest.mark.parametrize(("complete", "of_image"), [(None, 0.0), (double, 0.5)])
def test_a_force_takes_no_more_than_the_momentum(complete, of_image):
    """An image that gives as much takes its half of it."""
    grid = Grid(np.zeros(1), np.full(1, 4.0), np.ones(1), 0, 2)
    grid.active, grid.active_version = np.arange(5), 1
    load = Absorbing(name="a", on={"plane": {"axis": "x", "at": 4.0}})
    areas = np.array([[1.0], [0.5], [0.0], [-0.5], [-1.0]])
    dashpots = PlaneDashpots([(load, np.full((1, 1), 3.0))], grid, lambda Z: Z[0] * areas, complete)
    mp = np.array([[1.0, 2.0]] * 4 + [[0.5, 2.0]])
    f = np.zeros((5, 1))
    dashpots.add(0.0, mp, f, 0.01)
    assert f.T.tolist() == [[0.0, 0.0, 0.0, 0.0, pytest.approx(-3.0 * 2.0 / 0.5)]]
    f[:] = 0.0
    dashpots.add(0.0, mp, f, 1.0)
    assert f[4, 0] == -2.0 * (1.0 - of_image)
    mp[4, 0] = 0.0
    f[:] = 0.0
    dashpots.add(0.0, mp, f, 1.0)
    assert f[4, 0] == 0.0


HALF = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [4, 4], cell: 1}
method: {shape: b2gimp, transfer: {kind: flip}}
materials: {m: {kind: linear_elastic, E: 1, nu: 0, density: 1}}
bodies:
  - {name: b, material: m, region: {kind: box, lower: [LEFT, 1], upper: [3, 2]}, velocity: [0, -0.01]}
boundary: SYMMETRY
loads:
  - {name: base, kind: absorbing, on: {plane: {axis: y, at: 1}}}
time: {end: 1, step: 0.5}
"""


def test_forces_on_light_nodes_beside_a_symmetry_plane_are_those_of_the_whole(plain_python):
    motions = []
    for left, symmetry in (
        ("1", "[]"),
        ("2", "[{name: s, kind: symmetry, plane: {axis: x, at: 2, side: lower}}]"),
    ):
        with plain_python():
            s = Simulation(load_scene(HALF.replace("LEFT", left).replace("SYMMETRY", symmetry)))
            right = s.particles.X[0] > 2.0
            s.step()
        motions.append(s.particles.V[:, right])
    assert (motions[0][1] > -0.009).any()
    assert motions[1] == pytest.approx(motions[0], abs=1e-15)


@pytest.mark.parametrize(
    ("place", "words"),
    [
        (
            "{plane: {axis: y, at: 1.25}}",
            "a plane that absorbs waves must lie on a grid line; this one is 1.25 cells",
        ),
        ("{plane: {axis: y, at: 5}}", "the plane y = 5 lies outside the grid"),
        ("{plane: {axis: z, at: 1}}", "there is no axis z"),
        ("{body: left}", "give either plane, or body with face"),
        ("{body: left, plane: {axis: y, at: 1}}", "give either plane, or body with face"),
    ],
)
def test_places_that_are_refused(place, words):
    with pytest.raises(SceneError) as error:
        load_scene(SCENE.replace("PLACE", place))
    assert any(words in problem.message for problem in error.value.problems)


def test_waves_leave_along_periodic_axes_no_more_than_bodies_do():
    scene = SCENE.replace("cell: 1}", "cell: 1, periodic: [y]}").replace("PLACE", PLANE)
    with pytest.raises(SceneError, match="no wave can leave across the periodic axis y"):
        load_scene(scene)


def column(analysis="plane_strain", periodic="", boundary="", contact="", bodies=("[0, 2], upper: [2, 10]",)):
    """A column along the last axis, on an absorbing plane at 2, with a pulse that runs down; free sides or others."""
    d = 1 if analysis.startswith("uniaxial") else 2
    axis = "xy"[d - 1]
    lower, upper = ([0] * d, [12] if d == 1 else [2, 12])
    velocity = ["0"] * (d - 1) + [f"0.01*exp(-({axis} - 5)**2)"]
    filled = "\n".join(
        f"  - {{name: b{k}, material: m, region: {{kind: box, lower: {box}}}, velocity: {velocity}}}"
        for k, box in enumerate(bodies)
    )
    return f"""
version: 1
analysis: {{kind: {analysis}}}
grid: {{lower: {lower}, upper: {upper}, cell: 1{periodic}}}
method: {{shape: ugimp, transfer: {{kind: fmpm, order: 2}}}}
materials:
  m: {{kind: linear_elastic, E: 4, nu: 0.25, density: 2}}
bodies:
{filled}
{boundary}
{contact}
loads:
  - {{name: base, kind: absorbing, on: {{plane: {{axis: {axis}, at: 2}}}}}}
time: {{end: 20, step: 0.2}}
"""


SIDES = """boundary:
  - {name: left, kind: symmetry, plane: {axis: x, at: 0}}
  - {name: right, kind: symmetry, plane: {axis: x, at: 2}}"""
ROLLERS = """boundary:
  - {name: left, kind: velocity, on: {plane: {axis: x, at: 0}}, direction: x, value: 0}
  - {name: right, kind: velocity, on: {plane: {axis: x, at: 2}}, direction: x, value: 0}"""


@pytest.mark.parametrize(
    "words",
    [
        {"periodic": ", periodic: [x]"},
        {"boundary": SIDES},
        {"boundary": ROLLERS},
        {"boundary": ROLLERS, "analysis": "axisymmetric"},
        {
            "boundary": ROLLERS,
            "contact": "contact: {law: {kind: perfect}}",
            "bodies": ("[0, 2], upper: [1, 10]", "[1, 2], upper: [2, 10]"),
        },
    ],
    ids=["periodic", "symmetry", "rollers", "axisymmetric", "fields"],
)
def test_a_column_absorbs_as_a_bar_does(plain_python, words):
    with plain_python():
        bar = Simulation(load_scene(column("uniaxial_strain", bodies=("[2], upper: [10]",))))
        wide = Simulation(load_scene(column(**words)))
        for _ in range(30):
            bar.step()
            wide.step()
    left = bar.particles.V[0][np.argsort(bar.particles.X[0])]
    assert np.abs(left).max() < 0.004  # of 0.01, because half of the pulse has left
    for height, speed in zip(wide.particles.X[1], wide.particles.V[1], strict=True):
        exact = np.interp(height, np.sort(bar.particles.X[0]), left)
        assert speed == pytest.approx(exact, abs=1e-8)
