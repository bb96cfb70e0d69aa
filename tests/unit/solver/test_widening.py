"""Particles that stretch over more nodes than their stencil spans: it widens, and nothing is lost."""

import numpy as np
import pytest


@pytest.mark.parametrize("update", ["usl", pytest.param("usf", marks=pytest.mark.slow)])
def test_stencils_widen_as_particles_stretch(update, bar):
    """The bar is drawn out; mass and momentum stay those of the particles, the run goes on as before."""
    run = bar(method__update=update, boundary=[], method__transfer={"kind": "fmpm", "order": 2})
    s = run.simulation
    narrow = s.grid.width
    run.steps(2)
    run.particles.F[0, 20:24] = 5.0
    before = run.momentum[0]
    run.steps(3)
    assert narrow < s.grid.width <= s.transfer.widest
    assert len(s.transfer.across) == s.grid.width
    assert run.momentum[0] == pytest.approx(before, abs=1e-12)
    assert s.grid.mp[:, 0].sum() == pytest.approx(run.particles.mass.sum(), rel=1e-13)
    assert np.isfinite(run.particles.tau).all()


def test_domains_of_a_step_are_those_of_its_start(bar):
    """USF changes F before the forces: stencils keep a copy, also in the step in which they widen."""
    run = bar(method__update="usf", boundary=[], method__transfer={"kind": "fmpm", "order": 2})
    s = run.simulation
    run.particles.F[0, 20:24] = 5.0
    s.transfer.begin_step()
    s.transfer.extrapolate(s.velocity)
    assert s.grid.width > s.plan.shape.width
    assert not np.shares_memory(s.transfer._domain_F, run.particles.F)
    np.testing.assert_array_equal(s.transfer._domain_F, run.particles.F)


def test_rigid_bodies_move_alone_where_stencils_widen(block):
    """Wider stencils sort the particles again: positions of the rigid body go to its own particles, not to others."""
    soft = {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}
    left = {"name": "left", "material": "soft", "region": {"kind": "box", "lower": [-3, -2], "upper": [0, 2]},
            "velocity": [0, 1.5]}  # fmt: skip
    wall = {"name": "wall", "material": "tool", "region": {"kind": "box", "lower": [0, -4], "upper": [2, 3]},
            "velocity": [0.5, 0]}  # fmt: skip
    law = {"kind": "frictionless"}
    run = block(
        materials={"soft": soft, "tool": {"kind": "rigid"}}, bodies=[left, wall], contact={"law": law},
        method__shape="lcpdi",
    )  # fmt: skip
    s, p = run.simulation, run.particles
    run.steps(20)
    narrow = s.grid.width
    p.F[0, p.body == 0] = 5.0
    before = p.X[:, np.argsort(p.id)]
    run.steps(1)
    assert s.grid.width > narrow
    moved = np.abs(p.X[:, np.argsort(p.id)] - before).max()
    assert moved < 0.2
