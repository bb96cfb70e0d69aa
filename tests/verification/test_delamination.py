"""Double cantilever of two arms joined by a cohesive law: beam theory before growth, G_c while it grows."""

from pathlib import Path

import numpy as np
import pytest

INPUTS = Path(__file__).parents[2] / "inputs"

E, NU, HEIGHT, LENGTH, NOTCH, TOUGHNESS = 2300.0, 0.33, 6.0, 60.0, 24.9, 0.2
BENDING = E / (1.0 - NU**2) * HEIGHT**3 / 12.0
CORRECTION = 0.669 * HEIGHT
"""χ h: arms turn at their ends as if they were longer by this."""


def run_to_rest(start, *sets):
    """Rows of time, opening per arm, load and what broke, spent and is stored, every ten steps."""
    run = start("delamination.yaml", *sets)
    s = run.simulation
    rows = []
    while s.time < 3.5:
        for _ in range(10):
            s.step()
        view, work = s.contact.view.interfaces, s.state.work
        rows.append([
            s.time, min(s.time / 2.5, 1.0), s.state.reactions["up"][1], view.broken_area[0], view.cohesive_work[0],
            view.energy[0], work["boundary_work"] - work["damping_work"] - run.kinetic_energy - run.stress_work,
        ])  # fmt: skip
    return np.array(rows).T


@pytest.mark.slow
def test_load_and_toughness(start):
    """The load before growth, √(E'I G_c)/(a + χh) during growth, energy per area, and where the crack stops."""
    time, opening, load, broken, spent, stored, taken = run_to_rest(start)

    def mean(first: float, last: float) -> float:
        chosen = (time > first) & (time < last)
        return float(np.mean((load / opening)[chosen]))

    # before: the joint itself gives a little
    stiffness = 3.0 * BENDING / (NOTCH + CORRECTION) ** 3
    assert 0.95 < mean(0.7, 1.4) / stiffness < 1.0
    # as it grows, energy per area from one broken row of nodes to the next
    at = np.flatnonzero(np.diff(broken) > 0.2) + 1
    assert len(at) >= 7
    slope = np.polyfit(broken[at], spent[at], 1)[0]
    assert slope == pytest.approx(TOUGHNESS, rel=0.03)
    # all that the grips worked and the arms do not hold is in the joint
    assert taken[-1] == pytest.approx(spent[-1] + stored[-1], rel=0.03)
    # at rest: half of the process zone is debonded, as far as the load knows
    rest = time > 3.0
    force = float(np.mean(load[rest]))
    compliant = (3.0 * BENDING / force) ** (1.0 / 3.0) - CORRECTION
    assert compliant == pytest.approx(34.0, abs=1.5)
    assert force == pytest.approx(np.sqrt(BENDING * TOUGHNESS) / (compliant + CORRECTION), rel=0.05)
    assert NOTCH + broken[-1] == pytest.approx(34.0, abs=1.5)


SLAB = [
    ("kind: plane_strain", "kind: 3d"),
    ("lower: [-2, -15.5], upper: [63, 15.5]", "lower: [-2, -15.5, 0], upper: [63, 15.5, 1]"),
    ('lower: [0, "-height"], upper: ["length", 0]', 'lower: [0, "-height", 0], upper: ["length", 0, 1]'),
    ('lower: [0, 0], upper: ["length", "height"]', 'lower: [0, 0, 0], upper: ["length", "height", 1]'),
    (
        '["length - 0.5", 2], upper: ["length + 0.5", 4]',
        '["length - 0.5", 2, -0.5], upper: ["length + 0.5", 4, 1.5]',
    ),
    (
        '["length - 0.5", -4], upper: ["length + 0.5", -2]',
        '["length - 0.5", -4, -0.5], upper: ["length + 0.5", -2, 1.5]',
    ),
    ('near: ["length", "height/2"]', 'near: ["length", "height/2", 0.5]'),
    (
        "boundary:",
        "boundary:\n  - {name: front, kind: symmetry, plane: {axis: z, at: 0}}\n"
        "  - {name: back, kind: symmetry, plane: {axis: z, at: 1}}",
    ),
]
"""What makes the plane scene a slab of one cell between planes of symmetry."""


@pytest.mark.slow
def test_a_slab_in_space_is_the_plane(start):
    """Pulled faster, until three rows have failed: load, damage and energies within 2 %."""
    plane = slab = (INPUTS / "delamination.yaml").read_text(encoding="utf-8")
    for old, new in SLAB:
        assert slab.count(old) == 1
        slab = slab.replace(old, new)
    sides = {}
    for name, words in (("plane", plane), ("slab", slab)):
        run = start(words, "time={end: 1, step: 2.3e-4}", "constants.rise=0.8")
        s, load = run.simulation, []
        while s.time < 0.72:
            s.step()
            load.append(s.state.reactions["up"][1])
        view = s.contact.view.interfaces
        sides[name] = [np.mean(load), run.stress_work, view.cohesive_work.sum(), view.broken_area.sum()]
    assert sides["plane"][3] > 0.9
    assert sides["slab"] == pytest.approx(sides["plane"], rel=0.02)
