"""Friction on planes and walls that hold nodes: a block on an incline, by gravity that is turned."""

import numpy as np
import pytest
import yaml

from mpmcli.boundary.impose import Entries
from mpmcli.boundary.plane_friction import PlaneFriction
from mpmcli.core.errors import SceneError
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

G, ANGLE, RISE, END = 0.01, np.radians(30.0), 10.0, 40.0
FLOOR = {"kind": "velocity", "on": {"plane": {"axis": "y", "at": 0}}, "direction": "y", "value": 0}
WALL = {"kind": "wall", "normal": "y", "position": 0, "velocity": 0, "depth": 0}


def scene_of(floor, transfer, friction, cohesion, boundary=(), **keys):
    gravity = [f"{G * np.sin(ANGLE)}*ramp(t, 0, {RISE})", f"{-G * np.cos(ANGLE)}*ramp(t, 0, {RISE})"]
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [0, -2], "upper": [40, 6], "cell": 1},
        "method": {"shape": "lcpdi", "transfer": transfer},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}},
        "bodies": [
            {
                "name": "block",
                "material": "soft",
                "region": {"kind": "box", "lower": [4, 0], "upper": [10, 3]},
            }
        ],
        "boundary": [{"name": "floor", "friction": friction, "cohesion": cohesion} | floor, *boundary],
        "loads": [{"name": "g", "kind": "body_force", "acceleration": gravity}],
        "time": {"end": END, "courant": 0.2},
    } | keys


def slide(scene):
    """Mean acceleration after gravity has risen, mean reaction, the work of friction, and the energy's change."""
    s = Simulation(load_scene(yaml.safe_dump(scene)))
    p, balance = s.particles, EnergyBalance()
    reactions, speeds = [], {}
    while s.time < END:
        s.step()
        if s.time > RISE:
            speeds.setdefault("first", ((p.mass * p.V[0]).sum() / p.mass.sum(), s.time))
            reactions.append(s.state.reactions["floor"])
            balance.update(Snapshot(s.state))
    speed, time = speeds["first"]
    a = ((p.mass * p.V[0]).sum() / p.mass.sum() - speed) / (s.time - time)
    return s, a, np.mean(reactions, axis=0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("transfer", "floor", "cohesion"),
    [
        ({"kind": "flip"}, FLOOR, 0.0),
        ({"kind": "flip"}, WALL, 0.005),
        ({"kind": "xpic", "order": 3}, FLOOR, 0.0),
        ({"kind": "fmpm", "order": 2}, FLOOR, 0.005),
        ({"kind": "fmpm", "order": 4}, WALL, 0.0),
        ({"kind": "fmpm", "order": 4}, FLOOR, 0.005),
    ],
)
def test_a_block_slides_on_a_held_plane(transfer, floor, cohesion):
    """a = g (sin θ − μ cos θ) − c A/m; the force along the plane is μ N + c A."""
    mu = 0.3 if cohesion == 0.0 else 0.2
    s, a, (along, normal) = slide(scene_of(floor, transfer, mu, cohesion))
    weight = s.particles.mass.sum() * G
    assert normal == pytest.approx(weight * np.cos(ANGLE), rel=0.01)
    assert -along == pytest.approx(mu * normal + 6.0 * cohesion, rel=0.01)
    exact = G * (np.sin(ANGLE) - mu * np.cos(ANGLE)) - 6.0 * cohesion / s.particles.mass.sum()
    assert a == pytest.approx(exact, rel=0.002)
    work = s.state.extra["boundary_friction_work"]
    assert work == pytest.approx(-s.state.work["boundary_work"], rel=1e-12)
    kinetic = 0.5 * (s.particles.mass * np.square(s.particles.V).sum(axis=0)).sum()
    assert work == pytest.approx(
        s.state.work["external_work"] - kinetic - s.particles.stress_work.sum(), rel=0.02
    )


@pytest.mark.slow
@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 4}])
def test_a_block_rests_below_the_angle_of_friction(transfer):
    s, a, (along, normal) = slide(scene_of(FLOOR, transfer, 0.7, None))
    assert abs(a) < 0.01 * G
    assert -along / normal == pytest.approx(np.tan(ANGLE), rel=0.02)
    assert np.abs(s.particles.V).max() < 0.02


@pytest.mark.slow
def test_serial_and_parallel_kernels_agree(monkeypatch):
    from mpmcli.solver import simulation

    mirror = {"name": "m", "kind": "symmetry", "plane": {"axis": "x", "at": 4, "side": "lower"}}
    found = []
    for least in (0, 10**9):
        monkeypatch.setattr(simulation, "PARALLEL_FROM", least)
        scene = scene_of(FLOOR, {"kind": "fmpm", "order": 3}, 0.3, 0.01, [mirror])
        s = Simulation(load_scene(yaml.safe_dump(scene)), threads=2)
        for _ in range(6):
            s.step()
        found.append({name: np.asarray(array).tobytes() for name, array in s.state_arrays().items()})
    assert found[0] == found[1]


def entries_of(nodes, directions, owners):
    n = len(nodes)
    repeated = np.zeros(n, dtype=bool)
    return Entries(
        np.array(nodes), np.array(directions, float), np.zeros(n), repeated, np.array(owners), (0.0,) * 3
    )


def test_momenta_of_held_nodes():
    """Nodes that slide, that stick, that are pulled off, and in a corner that is held along x, too."""
    y, x = [0, 1, 0], [1, 0, 0]
    entries = entries_of([0, 1, 2, 3, 3], [y, y, y, x, y], [0, 0, 0, 1, 0])
    mp = np.array([[2.0, 3, 0, 4], [2.0, 0.3, 0, 0.4], [2.0, 3, 0, 4], [2.0, 0, 0, -5]])
    f = np.zeros((4, 3))
    f[:, 1] = [-10, -10, 10, -10]  # before the reactions
    friction = PlaneFriction(0, 0.5, 0.0, 1.0, None)
    friction.begin(entries)
    impulse = np.array([1.0, 1.0, -1.0, 0.0, 1.0])
    dt = 0.1
    f[:, 1] += impulse[[0, 1, 2, 4]] / dt
    friction.press(f, impulse, dt)
    for _ in range(2):  # a second time nothing is added
        friction.on_momenta(mp, f, dt)
        np.testing.assert_allclose(mp[0, 1:], [3 - 0.3, 0, 4 - 0.4])
        np.testing.assert_allclose(mp[1, 1:], 0.0, atol=1e-15)
        np.testing.assert_allclose(mp[2, 1:], [3, 0, 4])
        np.testing.assert_allclose(mp[3, 1:], [0, 0, -4.5])
    share = np.ones(5)
    np.testing.assert_allclose(friction.reaction(dt, share), friction.impulse.sum(axis=0) / dt)
    dv = np.ones((4, 3))
    friction.on_increment(dv, mp, True)
    np.testing.assert_allclose(dv, [y, y, y, [1, 1, 0]])
    np.testing.assert_allclose(friction.impulse[0], [-0.3 - 2.0, 0, -0.4 - 2.0])


@pytest.mark.parametrize(
    ("floor", "method", "words"),
    [
        (FLOOR | {"direction": "x"}, {}, "friction needs the velocity across the plane"),
        (FLOOR, {"velocity_conditions": "velocity"}, "the friction of 'floor' acts on momenta"),
        (FLOOR | {"friction": -0.1}, {}, "at least 0"),
    ],
)
def test_friction_that_cannot_be(floor, method, words):
    scene = scene_of(floor, {"kind": "fmpm", "order": 4}, 0.3, None)
    scene["method"] |= method
    with pytest.raises(SceneError) as caught:
        load_scene(yaml.safe_dump(scene))
    assert words in caught.value.problems[0].message
