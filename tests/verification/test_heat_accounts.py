"""Heat, entropy and energy of an isolated body."""

import exact_heat as exact
import numpy as np
import pytest
from heat_runs import transfer

TIGHT = 1e-12


@pytest.mark.parametrize("method", ["FLIP", "FLIP(4)", "FMPM(1)", "FMPM(4)"])
def test_two_bars_come_to_one_temperature(start, method):
    """350 K, the entropy of mixing, no change of energy; entropy never falls."""
    run = start("equalising_bars.yaml", transfer(method))
    p = run.particles
    assert sorted(set(p.body)) == [0, 1]
    heat, bar = 350.0 * 10, run.particles.mass.sum() / 2

    def watch(r):
        return float(r.received("entropy").sum()), float(r.received("heat_inflow").sum())

    start_of_all = watch(run)
    entropy, inflow = np.array([start_of_all, *run.to(250, watch)]).T
    end, grown = exact.equalised((300, 400), (bar, bar))
    assert np.abs(run.ordered("T") / end - 1).max() < 1e-6
    assert entropy[-1] == pytest.approx(grown, rel=1e-6)
    assert np.abs(inflow).max() < TIGHT * heat
    assert np.diff(entropy).min() > -1e-14
