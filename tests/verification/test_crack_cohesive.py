"""A double cantilever whose crack has a cohesive zone on its chain (L17): beam theory, and G_c while it grows."""

import numpy as np
import pytest

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1200)]

TOUGHNESS, NOTCH, RISE, END = 0.2, 24.9, 2.5, 3.5
BENDING, CORRECTION = 2300.0 / (1.0 - 0.33**2) * 18.0, 0.669 * 6.0
"""E'I of an arm [N mm²] and χh [mm]."""


def test_load_toughness_and_arrest(start):
    run = start("cohesive_cantilever.yaml")
    s, rows = run.simulation, []
    view, work = s.cracks.view, s.state.work
    while s.time < END:
        s.step()
        rows.append((
            s.time, min(s.time / RISE, 1.0), s.state.reactions["up"][1],
            view.debonded_length[0], view.cohesive_work[0],
        ))  # fmt: skip
    time, opening, load, debonded, spent = np.array(rows).T

    # before growth: the tractions ahead of the notch give as the root of a beam does
    early = (time > 0.7) & (time < 1.4)
    stiffness = 3.0 * BENDING / (NOTCH + CORRECTION) ** 3
    assert np.mean(load[early] / opening[early]) == pytest.approx(stiffness, rel=0.07)
    # while it grows: the curve of constant energy release rate
    force = np.sqrt(BENDING * TOUGHNESS)
    growing = (debonded > 0.0) & (time < RISE)
    constant = force / np.sqrt(3.0 * BENDING * opening[growing] / force)
    assert np.mean(load[growing] / constant) == pytest.approx(1.0, rel=0.06)
    # energy per area, from one failed point to the next
    at = np.flatnonzero(np.diff(debonded) > 0.0) + 1
    assert len(at) >= 15
    assert np.polyfit(debonded[at], spent[at], 1)[0] == pytest.approx(TOUGHNESS, rel=0.03)
    # all that the grips worked and the arms do not hold is in the tractions
    held = spent[-1] + view.interface_energy[0]
    taken = work["boundary_work"] - work["damping_work"] - run.kinetic_energy - run.stress_work
    assert work["interface_work"] == pytest.approx(held, rel=0.01)
    assert taken == pytest.approx(held, rel=0.03)
    # at rest: how long the crack is, by what has failed and by the load
    rest = np.mean(load[time > 3.0])
    reach = (3.0 * BENDING / rest) ** (1.0 / 3.0)
    assert NOTCH + debonded[-1] == pytest.approx(34.0, abs=1.5)
    assert reach - CORRECTION == pytest.approx(34.0, abs=1.5)
    assert rest == pytest.approx(force / reach, rel=0.06)
