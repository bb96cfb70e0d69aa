"""The jump at the interface, and what the way to the node adds to it."""

import numpy as np
import pytest
import yaml

from mpmcli.contact.laws import LAWS
from mpmcli.interfaces.base import BREAKS, HISTORY
from mpmcli.interfaces.impulses import go_to_node
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

AT = 0.37
"""Place of the interface; cells are of size 1."""


@pytest.fixture(autouse=True)
def in_python(plain_python):
    """Nothing is compiled."""
    with plain_python():
        yield


SHAPE = {"shape": "triangular", "strength": 50, "toughness": 2}
SPRINGS = {"kind": "linear_interface", "normal": 50, "tangential": 50}


def bars(order=5, law=SPRINGS, **interface):
    """Two bars that meet beside a grid line, the right one stretched by 2 %."""
    boxes = {"left": (AT - 4, AT), "right": (AT, AT + 4)}
    scene = {
        "version": 1,
        "analysis": {"kind": "uniaxial_strain"},
        "grid": {"lower": [-6], "upper": [6], "cell": 1},
        "method": {"shape": "ugimp", "transfer": {"kind": "fmpm", "order": order}},
        "materials": {"soft": {"kind": "linear_elastic", "density": 1, "E": 1, "nu": 0}},
        "bodies": [
            {
                "name": name,
                "material": "soft",
                "particles_along": "region",
                "region": {"kind": "box", "lower": [low], "upper": [high]},
            }
            for name, (low, high) in boxes.items()
        ],
        "contact": {"law": law, "interface": interface},
        "time": {"end": 1, "step": 0.1},
    }
    s = Simulation(load_scene(yaml.safe_dump(scene)), threads=1)
    p = s.particles
    right = p.body == 1
    p.F[0, right] = 1.02
    p.X[0, right] = AT + (p.X0[0, right] - AT) * 1.02
    return s


def rows_of(s):
    """Contacts after a step, and the places of their nodes from the interface."""
    s.step()
    c, g = s.contact.contacts, s.grid
    nodes = g.lower[0] - g.pad * g.cell[0] + c.table.node[c.fields.slot[: c.count]] * g.cell[0]
    return c, s.contact.interfaces.jumps, nodes - AT


def test_the_way_to_the_node_is_strained():
    s = bars()
    c, jumps, away = rows_of(s)
    assert c.count == 2
    assert np.abs(jumps.jump[:2]).max() < 1e-12
    F = 0.5 * (1.0 + 1.02)  # about the mean of both sides, whose masses at a node differ
    strain = 1.0 - 1.0 / 1.02
    normal = c.geometry.normal[:2, 0]
    sign = np.sign(normal) if c.fields.alpha[0] < c.fields.partner[0] else -np.sign(normal)
    np.testing.assert_allclose(jumps.aside[:2, 0] * sign, strain * F * away, rtol=0.02)
    np.testing.assert_allclose(jumps.mass[:2], 0.25, rtol=1e-12)
    # they cancel over the nodes
    assert abs(np.sum(c.geometry.area[:2] * jumps.aside[:2, 0])) < 2e-4


def test_a_jump_by_mean_displacements_has_no_place():
    _, jumps, _ = rows_of(bars(jump="extrapolated"))
    assert not jumps.aside[:2].any()


def test_orders_that_are_stable_without_it_leave_the_jump_at_the_interface():
    _, jumps, _ = rows_of(bars(order=4))
    assert not jumps.aside[:2].any()


def test_stiff_springs_act_at_the_node():
    """J = m_red/Δt φ²/(1 + φ²) times a share of the way to the node, by direction."""
    law = LAWS["linear_interface"].model_validate(
        {"kind": "linear_interface", "normal": 50, "tangential": 0.5}
    )
    n, slip, aside = np.array([0.6, 0.8]), np.array([0.8, -0.6]), np.array([0.01, 0.03])
    area, reduced, mass, dt, out = 0.7, 0.2, 0.25, 0.1, np.zeros(2)
    go_to_node(
        law.parameters(), (0.0, 0.0), n, area, np.zeros(2), aside, mass, np.zeros(HISTORY), reduced, dt, out
    )
    for direction, stiffness in ((n, 50.0), (slip, 0.5)):
        square = stiffness * area * dt**2 / reduced
        common = stiffness * dt**2 / mass
        share = square / (1.0 + square) * common / (1.0 + common)
        assert out @ direction == pytest.approx(reduced / dt * share * (aside @ direction), rel=1e-12)


@pytest.mark.parametrize(
    ("law", "numbers", "waits"),
    [
        ({"kind": "linear_interface", "normal": 50, "tangential": 50}, 1, True),
        ({"kind": "linear_interface", "normal": "perfect", "tangential": 50}, 1, False),
        ({"kind": "bilinear_interface", "tension": 5, "compression": "perfect", "tangential": 5}, 1, True),
        ({"kind": "bilinear_interface", "tension": 5, "compression": 5, "tangential": "perfect"}, 1, False),
        ({"kind": "morse_interface", "stiffness": 50, "peak": 5}, 1, True),
        ({"kind": "morse_interface", "stiffness": 50, "peak": 5, "tangential": "perfect"}, 1, False),
        ({"kind": "cohesive", "normal": SHAPE, "tangential": SHAPE}, 3, True),
    ],
)
def test_what_particles_keep_and_which_interfaces_wait_for_forces(law, numbers, waits):
    """Springs do nothing to momenta that are only extrapolated; what breaks does, as perfect directions do."""
    s = bars(law=law)
    s.step()
    joints = s.contact.interfaces
    assert s.particles.interface.shape == (numbers, s.particles.count)
    joints.forces_known(False)
    assert joints.waits == waits
    joints.forces_known(True)
    assert not joints.waits
    s.particles.interface[:] = 1.0
    s.step()
    assert (joints.jumps.history[: s.contact.contacts.count, BREAKS] > 0.5).all()
    joints.forces_known(False)
    assert not joints.waits
    assert set(joints.particle_damages()) == {1.0}
