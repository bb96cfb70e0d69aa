"""Interfaces at their limits: finite, momentum kept, no energy made, and what goes wrong is reported."""

from typing import Any

import numpy as np
import pytest
from joined_runs import JOINT, SOFT, JoinedRun, box

pytestmark = pytest.mark.slow

TRANSFERS = [{"kind": "flip"}, {"kind": "fmpm", "order": 4}]
IDS = ["flip", "fmpm4"]
PEEL: dict[str, Any] = {
    "kind": "cohesive",
    "normal": {"shape": "triangular", "strength": 2, "toughness": 0.1},
    "tangential": {"shape": "triangular", "strength": 2, "toughness": 0.1},
}
BLOCKS = [
    box("left", [-4, -2], [0, 2], ["-0.2*cos(x/4)", 0]),
    box("right", [0, -2], [4, 2], ["0.2*cos(x/4)", 0]),
]


def is_finite(run: JoinedRun) -> bool:
    """Whether all numbers of the particles are."""
    return all(np.isfinite(getattr(run.s.particles, name)).all() for name in ("X", "V", "F", "tau"))


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("ratio", [1e6, 1e-6])
@pytest.mark.parametrize("what", ["density", "E"])
def test_ratios_of_a_million_across_the_interface(what, ratio, transfer):
    """300 steps, which the stiffer or lighter side sees as many, the other as almost none."""
    other = {**SOFT, what: SOFT[what] * ratio}
    bodies = [BLOCKS[0], BLOCKS[1] | {"material": "other"}]
    run = JoinedRun(bodies, method__transfer=transfer, materials={"soft": SOFT, "other": other}).steps(300)
    assert is_finite(run)
    assert run.momentum_error < 1e-11
    assert run.highest < 1.05 * run.initial
    assert run.stored > 0.0


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
def test_an_interface_one_particle_wide(transfer):
    """A single particle glued to a block hangs on to it."""
    one = box("one", [0, 2], [0.5, 2.5], [0, 0.5])
    run = JoinedRun([box("block", [-3, -2], [3, 2], [0, 0]), one], method__transfer=transfer)
    assert (run.s.particles.body == 1).sum() == 1
    run.steps(400)
    assert is_finite(run)
    assert run.momentum_error < 1e-11
    assert run.highest < 1.05 * run.initial
    assert run.s.particles.X[1, run.s.particles.body == 1][0] < 2.25 + 0.25


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("stiffness", [0, 1e-6, 1e12])
def test_any_stiffness(stiffness, transfer):
    """Nothing holds free blocks; stiff ones oscillate as one, and the jump vanishes."""
    law = {"kind": "linear_interface", "normal": stiffness, "tangential": stiffness}
    run = JoinedRun(BLOCKS, law, method__transfer=transfer).steps(200)
    assert is_finite(run)
    assert run.momentum_error < 1e-11
    assert run.highest < 1.05 * run.initial
    if stiffness < 1.0:
        speed = [run.s.particles.V[0, run.s.particles.body == body].mean() for body in (0, 1)]
        assert speed[1] - speed[0] > 0.3
        assert run.stored < 1e-5
    else:
        assert abs(run.means.jump_normal[0]) < 1e-6


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("law", [JOINT, PEEL], ids=["linear", "cohesive"])
@pytest.mark.parametrize("share", [0.1, 1e-3, 1e-6, 1e-9])
def test_nodes_of_small_mass_ratio(share, law, transfer):
    """The interface lies so near to the next row of nodes that one side hardly reaches it."""
    grid = {"lower": [-12 - share, -12], "upper": [12 - share, 12], "cell": 1}
    whole = [
        box("left", [-4 - share, -2], [-share, 2], [-0.02, 0]),
        box("right", [-share, -2], [4 - share, 2], [0.02, 0]),
    ]
    run = JoinedRun(whole, law, method__transfer=transfer, grid=grid).steps(200)
    assert is_finite(run)
    assert run.momentum_error < 1e-11
    assert run.highest < 1.05 * run.initial
    assert run.view.broken_area.sum() == 0.0
    assert run.means.area[0] == pytest.approx(4.0, rel=0.03)


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize(("cells", "told"), [(0.9, False), (2.1, True)])
def test_wide_openings(cells, told, transfer):
    """Blocks that a soft interface lets go so far that nodes lose sight of a side: counted, and nothing breaks down."""
    law = {"kind": "linear_interface", "normal": 0.05, "tangential": 0.05}
    bodies = [box("left", [-4, -2], [0, 2], [-0.5, 0]), box("right", [0, -2], [4, 2], [0.5, 0])]
    run = JoinedRun(bodies, law, method__transfer=transfer)
    seen = 0.0
    while seen < cells and run.s.time < 5.0:
        run.steps(1)
        right, left = (run.s.particles.X[0, run.s.particles.body == body] for body in (1, 0))
        seen = float(right.min() - left.max()) - 0.5
    assert seen >= cells
    assert is_finite(run)
    assert run.momentum_error < 1e-11
    assert run.highest < 1.05 * run.initial
    assert (run.view.all_lost > 0) == told


def rest(law: dict[str, Any], transfer: dict[str, Any], steps: int) -> None:
    """A block hangs from a held one; once at rest, its jump is that of its weight and does not move."""
    bodies = [box("upper", [0, 0], [4, 2]), box("lower", [0, -2], [4, 0])]
    held = {
        "name": "held",
        "kind": "velocity",
        "on": {"plane": {"axis": "y", "at": 2}},
        "direction": "y",
        "value": 0,
    }
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, -0.1]}
    run = JoinedRun(
        bodies, law, method__transfer=transfer, boundary=[held], loads=[weight], method__damping={"grid": 2.0},
        time={"end": 1e6, "step": 0.01}, grid={"lower": [-4, -8], "upper": [8, 2], "cell": 1},
    )  # fmt: skip
    for _ in range(2000):
        run.s.step()
    first = run.means.jump_normal[0]
    for _ in range(steps):
        run.s.step()
    means = run.means
    assert is_finite(run)
    assert means.traction_normal[0] == pytest.approx(0.2, rel=0.02)
    assert means.jump_normal[0] == pytest.approx(first, rel=1e-3)
    assert means.jump_tangential[0] < 0.05 * first
    assert run.view.cohesive_work.sum() == run.view.broken_area.sum() == 0.0


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("law", [JOINT, PEEL], ids=["linear", "cohesive"])
def test_at_rest_under_load(law, transfer):
    """10⁴ steps."""
    rest(law, transfer, 10_000)


BILINEAR = {"kind": "bilinear_interface", "tension": 50.0, "compression": 200.0, "tangential": 30.0}
MORSE = {"kind": "morse_interface", "stiffness": 50.0, "peak": 2.0, "tangential": 30.0}


@pytest.mark.parametrize(
    ("law", "transfer"),
    [(PEEL, "flip"), (PEEL, "fmpm4"), (JOINT, "fmpm4"), (BILINEAR, "flip"), (MORSE, "fmpm4")],
    ids=["cohesive-flip", "cohesive-fmpm4", "linear-fmpm4", "bilinear-flip", "morse-fmpm4"],
)
def test_long_at_rest_under_load(law, transfer):
    """10⁵ steps."""
    rest(law, TRANSFERS[IDS.index(transfer)], 100_000)
