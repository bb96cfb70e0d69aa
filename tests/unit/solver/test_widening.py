"""Particles that stretch over more nodes than their stencil spans: it widens, and nothing is lost."""

from __future__ import annotations

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
