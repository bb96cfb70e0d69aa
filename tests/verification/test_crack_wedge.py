"""A wedge splits a block: length of the crack, force and energy against beam theory."""

import numpy as np
import pytest
from crack_runs import WEDGE_FRICTION, wedge_force, wedge_opening, wedge_run

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]


def test_a_wedge_splits_a_block(start):
    """Its work is what the block stores and releases and what friction takes; the crack is as long as beams say."""
    run = start("wedge_splitting.yaml")
    u, a, force, work, *parts = np.array(run.to(2.0, wedge_run)).T
    times = np.linspace(0.0, 2.0, len(u) + 1)[1:]
    lengths = np.linspace(20.0, 40.0, 500)
    exact = np.interp(u, wedge_opening(lengths), lengths)
    begun = u[np.flatnonzero(a > 20.25)[0]]
    assert begun == pytest.approx(wedge_opening(np.array(20.0)), rel=0.15)
    grows = times > 0.9
    assert np.abs(a - exact)[grows].max() < 2.0
    assert force[grows].mean() == pytest.approx(wedge_force(exact[grows]).mean(), rel=0.12)
    excess = (np.sum(parts, axis=0) / work - 1.0)[times > 0.3]
    assert np.abs(excess).max() < 0.08  # an increment counts at once, before its waves take the energy
    block = int(0.24 / 2.0 * len(u))
    assert np.abs(np.convolve(excess, np.full(block, 1.0 / block), "valid")).max() < 0.04
    assert parts[2][-1] / work[-1] == pytest.approx(WEDGE_FRICTION, rel=0.05)
