"""A condition that holds nothing is said, not passed over in silence."""

import pytest

from mpmcli.explain.facts import explain
from mpmcli.scene.filling import check_filling
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """\
version: 1
analysis: {kind: uniaxial_stress}
grid: {lower: [0], upper: [20], cell: 1}
method: {transfer: {kind: fmpm, order: 2}}
materials: {m: {kind: linear_elastic, density: 1, E: 1, nu: 0}}
bodies: [{name: bar, material: m, region: {kind: box, lower: [2], upper: [8]}}]
boundary: [{name: support, kind: velocity, on: {plane: {axis: x, at: AT}}, direction: x, value: 0}]
time: {end: 1, courant: 0.2}
"""


@pytest.mark.parametrize("at", ["0", "20"])
def test_a_symmetry_plane_on_a_side_of_the_grid_may_wait(at, caplog):
    """It is a wall that something may come to; in the middle of nothing it holds nothing."""
    scene = SCENE.replace("kind: velocity, on: {plane: {axis: x, at: AT}}, direction: x, value: 0", "KIND")
    for place, said in ((at, False), ("18", True)):
        caplog.clear()
        kind = f"kind: symmetry, plane: {{axis: x, at: {place}}}"
        Simulation(load_scene(scene.replace("KIND", kind))).step()
        assert any("'support' holds no node" in record.message for record in caplog.records) == said


@pytest.mark.parametrize("kind", ["flip", "fmpm"])
@pytest.mark.parametrize(("at", "said"), [("20", 1), ("2", 0)])
def test_a_held_temperature_without_nodes_is_named_once(at, said, kind, caplog):
    """After the first heat step."""
    scene = (
        SCENE.replace("AT", at)
        .replace("kind: velocity", "kind: temperature")
        .replace("direction: x, value: 0", "value: 300")
        .replace("nu: 0}", "nu: 0, heat_capacity: 1, conductivity: 1}")
    )
    heat = f"heat={{transfer: {{kind: {kind}}}, interval: 2}}"
    simulation = Simulation(load_scene(scene, sets=[heat]))
    for _ in range(6):
        simulation.step()
    words = "boundary condition 'support' holds no node of a body at the start"
    assert [record.message for record in caplog.records] == [words] * said


@pytest.mark.parametrize(("at", "said"), [("20", 1), ("2", 0)])
def test_a_condition_without_nodes_is_named_once(at, said, caplog):
    simulation = Simulation(load_scene(SCENE.replace("AT", at)))
    for _ in range(3):
        simulation.step()
    words = "boundary condition 'support' holds no node of a body at the start"
    assert [record.message for record in caplog.records] == [words] * said


@pytest.mark.parametrize(("moves", "said"), [("velocity: [0.1]", False), ("velocity: [0]", True)])
def test_a_floor_on_a_side_of_the_grid_may_wait_for_a_body_that_moves(moves, said, caplog):
    scene = SCENE.replace("AT", "20").replace("upper: [8]}", f"upper: [8]}}, {moves}")
    Simulation(load_scene(scene)).step()
    assert any("'support' holds no node" in record.message for record in caplog.records) == said


FORCED = """\
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [6, 6], cell: 1}
method: {shape: SHAPE, transfer: {kind: flip}}
materials: {m: {kind: neo_hookean, density: 1, E: 100, nu: 0.3}}
bodies: [{name: a, material: m, region: {kind: box, lower: [1, 1], upper: [3, 3]}}]
loads: [{name: push, kind: nodal_force, at: [AT, 2.0], force: [1, 0]}]
time: {end: 1, step: 0.01}
"""


@pytest.mark.parametrize("at", [0.0, 0.4, 2.0, 3.0, 3.6, 4.0, 4.2, 5.0, 5.5, 6.0])
@pytest.mark.parametrize("shape", ["linear", "ugimp", "lcpdi", "bspline2"])
def test_a_nodal_force_is_warned_of_where_no_node_has_mass(shape, at, plain_python):
    """The warning at the start agrees with the masses of the nodes, for each reach of a shape function."""
    loaded = load_scene(FORCED.replace("SHAPE", shape).replace("AT", str(at)))
    with plain_python():
        simulation = Simulation(loaded)
        simulation.step()
    warned = [problem.message for problem in simulation.setup_warnings]
    assert (simulation.loads.force == 0.0).all() == bool(warned)
    assert all("at no node of a body" in words for words in warned)
    assert check_filling(loaded.scene) == simulation.setup_warnings


def test_explain_tells_of_a_nodal_force_without_a_body():
    facts = explain(load_scene(FORCED.replace("SHAPE", "ugimp").replace("AT", "5.0")))
    assert "loads.push.at: the nodal force at (5, 2) is at no node" in facts["text"]


PISTON = """\
[{name: a, material: m, region: {kind: box, lower: [1, 1], upper: [3, 3]}}]
boundary: [{kind: wall, name: piston, WALL}]"""


@pytest.mark.parametrize(
    ("wall", "is_behind"),
    [
        ("normal: x, position: '3 - t', velocity: -1", True),
        ("normal: x, position: '3 - t', velocity: -1, from: 1", False),
        ("normal: [-2, 0], position: '3 - t', velocity: -1", False),
        ("normal: [-2, 0], position: [0.9, 7], velocity: 1", True),
        ("normal: y, position: 2.6, velocity: 1", False),
        ("normal: [1, 1], position: [3, 3.1], velocity: 0", True),
        ("normal: [1, 1], position: [1, 1], velocity: 0", False),
    ],
)
def test_a_wall_with_all_of_a_body_behind_it_is_warned_of(wall, is_behind):
    """As with a normal that points out of the material: it would hold every node."""
    scene = FORCED.replace("SHAPE", "ugimp").replace("AT", "2.0")
    body = next(line for line in scene.splitlines() if line.startswith("bodies:"))
    found = check_filling(load_scene(scene.replace(body, "bodies: " + PISTON.replace("WALL", wall))).scene)
    assert [(each.path, each.code) for each in found] == [
        ("boundary.piston.normal", "behind_wall")
    ] * is_behind
