"""Sides that meet exactly begin to touch when they approach, whatever round-off makes of it."""

import numpy as np
import pytest

from mpmcli.contact.geometry import unsure
from mpmcli.contact.laws import LAWS
from mpmcli.contact.laws.impulse import APART, PARTING, SLIDING, STICKING, law_impulse
from mpmcli.contact.separation.base import APART as APART_FROM_NOTHING
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

AXES = (0.0, 0.0)

SCENE = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [{lower}, -8], upper: [{upper}, 8], cell: 0.1}}
method: {{shape: ugimp, transfer: {{kind: flip}}}}
materials: {{soft: {{kind: neo_hookean, density: 1, E: 100, nu: 0.3}}}}
bodies:
  - {{name: a, material: soft, region: {{kind: box, lower: [{a}, -0.2], upper: [{edge}, 0.2]}}}}
  - {{name: b, material: soft, region: {{kind: box, lower: [{edge}, -0.2], upper: [{b}, 0.2]}}}}
contact: {{law: {{kind: coulomb, friction: 0.3}}}}
time: {{end: 1, courant: 0.2}}
"""


def separations(at, moved=0.0):
    """Separations at the nodes of two blocks whose edges meet at ``at``, the right one then moved [cells]."""
    places = {"lower": at - 2.5, "upper": at + 2.5, "a": at - 0.25, "edge": at, "b": at + 0.25}
    s = Simulation(load_scene(SCENE.format(**places)), 1)
    p = s.particles
    p.X[0, p.body == 1] += 0.1 * moved
    s.step()
    c = s.contact.contacts
    found = c.geometry.separation[: c.count]
    return found[found < 0.5 * APART_FROM_NOTHING] / 0.1


@pytest.mark.slow  # compiles contact with ugimp
@pytest.mark.parametrize("at", [0.05, -3.35, 41.25, 70.55])
def test_edges_that_meet_exactly_are_not_in_contact_yet(at):
    """Wherever they are, and by no gap that matters; an overlap of 1e-9 cells is one."""
    inner = np.sort(np.abs(separations(at)))[:3]  # corners have tilted normals
    assert inner.max() < 2e-10
    assert (separations(at) > 0.0).sum() >= 3
    assert separations(at, -1e-9).max() < 0.0


def test_what_round_off_leaves_unsure():
    """Far from the origin positions have fewer digits in a cell."""
    shape = np.array([40, 40])
    near = unsure(AXES, 0.5, shape, (-10.0, -10.0), (0.5, 0.5))
    far = unsure(AXES, 0.5, shape, (1e6, -10.0), (0.5, 0.5))
    assert 0.5e-10 <= near < 1e-10
    assert 1e6 * np.finfo(float).eps < far - near < 1e-8


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize(
    ("kind", "numbers", "state", "kept"),
    [
        ("stick", {}, STICKING, 1.0),
        ("coulomb", {"friction": 0.3}, SLIDING, 0.0),
        ("frictionless", {}, SLIDING, 0.0),
    ],
)
def test_sides_that_slide_along_each_other_touch(kind, numbers, state, kept, sign):
    """Whichever way round-off turns the normal; nothing is pulled, and sides that part do part."""
    law = LAWS[kind].model_validate({"kind": kind, **numbers}).parameters()
    n, out = np.array([0.6, 0.8]), np.zeros(2)

    def of(normal, separation=-1e-12, displacement_only=False):
        dp0 = 2.0 * (normal * n + np.array([-0.8, 0.6]))
        return law_impulse(law, AXES, dp0, n, separation, 1.0, 1.0, 1.0, displacement_only, 0.0, out)

    assert of(sign * 0.1 * PARTING) == state
    assert out @ [-0.8, 0.6] == pytest.approx(2.0 * kept, abs=1e-8)
    assert out @ n <= 1e-16
    assert of(2 * PARTING) == APART
    assert of(-sign * 0.1 * PARTING, separation=0.0) == APART
    assert of(2 * PARTING, displacement_only=True) == state
