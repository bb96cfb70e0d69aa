"""Blocks pulled apart through cohesive joints: strength, energy, unloading, and failure of mixed modes."""

from typing import Any

import exact_cohesion as exact
import numpy as np
import pytest
import yaml

from mpmcli.interfaces.base import BREAKS, MOST_NORMAL, MOST_TANGENTIAL

pytestmark = pytest.mark.slow

AREA, STRENGTH, TOUGHNESS = 10.0, 5.0, 0.5
SHAPES: list[dict[str, Any]] = [
    {"shape": "triangular"},
    {"shape": "trilinear", "kink_opening": 0.4, "kink_strength": 0.3},
    {"shape": "cubic"},
    {"shape": "exponential", "alpha": 2.0},
]
NAMES = [keys["shape"] for keys in SHAPES]


def words(keys: dict[str, Any], toughness: float = TOUGHNESS) -> str:
    """A mode in the words of the scene."""
    return yaml.safe_dump(
        keys | {"strength": STRENGTH, "toughness": toughness}, default_flow_style=True
    ).strip()


class Pull:
    """The scene ``peel_apart.yaml`` while it runs: opening, stress that acts between the blocks, energies."""

    def __init__(self, start: Any, *sets: str):
        self.run = start("peel_apart.yaml", *sets)
        self.rows: list[list[float]] = []

    def to(self, end: float) -> dict[str, np.ndarray]:
        """Run; columns by name."""
        s = self.run.simulation
        while s.time < end:
            s.step()
            view, contact, work = s.contact.view.interfaces, s.contact.view, s.state.work
            means = view.means()
            self.rows.append([
                s.time, means.jump_normal[0], contact.force[0, 1] / AREA, means.area[0], view.cohesive_work[0],
                view.energy[0], view.broken_area[0], work["interface_work"], work["boundary_work"],
                self.run.kinetic_energy, self.run.strain_energy,
            ])  # fmt: skip
        names = [
            "t",
            "opening",
            "stress",
            "area",
            "spent",
            "stored",
            "broken",
            "interface",
            "boundary",
            "kinetic",
            "strain",
        ]
        return dict(zip(names, np.array(self.rows).T, strict=True))


@pytest.mark.parametrize("keys", SHAPES, ids=NAMES)
def test_strength_and_toughness_of_every_shape(start, keys):
    """What the blocks feel follows the envelope; it peaks at σ, and all that the grip worked is G A in the end."""
    mode = exact.Mode(keys, STRENGTH, TOUGHNESS)
    seen = Pull(start, f"contact.law.normal={words(keys)}").to(0.7)
    assert seen["stress"].max() == pytest.approx(STRENGTH, rel=0.01)
    bonded = seen["area"] > 0.99 * AREA
    follows = np.abs(seen["stress"] - mode.traction(seen["opening"]))[bonded]
    assert follows.max() < 0.04 * STRENGTH
    assert follows.mean() < 0.006 * STRENGTH
    last = {name: column[-1] for name, column in seen.items()}
    assert last["spent"] == pytest.approx(TOUGHNESS * AREA, rel=1e-4)
    assert last["interface"] == pytest.approx(TOUGHNESS * AREA, rel=0.02)
    assert last["boundary"] - last["kinetic"] - last["strain"] == pytest.approx(TOUGHNESS * AREA, rel=0.016)
    assert last["broken"] == pytest.approx(AREA, rel=0.01)
    assert last["area"] == last["stored"] == 0.0
    assert np.all(np.diff(seen["spent"]) >= 0.0)


@pytest.mark.parametrize("keys", SHAPES, ids=NAMES)
def test_work_of_the_grips_with_cells_of_half_the_size(start, keys):
    """All that the grips worked is G A within 1 %; with the cells of the scene within 1.5 %."""
    seen = Pull(start, f"contact.law.normal={words(keys)}", "grid.cell=1").to(0.7)
    work = (seen["boundary"] - seen["kinetic"] - seen["strain"])[-1]
    assert work == pytest.approx(TOUGHNESS * AREA, rel=0.01)
    assert seen["stress"].max() == pytest.approx(STRENGTH, rel=0.005)


@pytest.mark.parametrize("keys", SHAPES, ids=NAMES)
def test_unloading_and_reloading_go_through_the_origin(start, keys):
    """Turned back at about half the opening at failure and pulled again: a line, nothing spent on the way."""
    mode = exact.Mode(keys, STRENGTH, TOUGHNESS)
    seen = Pull(start, f"contact.law.normal={words(keys)}", "constants.turn=0.28", "constants.again=0.42").to(
        1.0
    )
    most = np.maximum.accumulate(seen["opening"])
    off = (seen["opening"] < 0.98 * most) & (seen["t"] > 0.28) & (seen["t"] < 0.7) & (seen["area"] > 0.0)
    assert off.sum() > 250
    assert seen["opening"][off].min() < 0.7 * most[off].max()
    line = mode.traction(most[off]) / most[off] * seen["opening"][off]
    assert np.abs(seen["stress"][off] - line).max() < 0.02 * STRENGTH
    assert np.ptp(most[off]) < 1e-12
    assert np.ptp(seen["spent"][off]) < 1e-3 * TOUGHNESS * AREA
    assert seen["spent"][-1] == pytest.approx(TOUGHNESS * AREA, rel=0.01)


@pytest.mark.parametrize("exponent", [1, 2])
@pytest.mark.parametrize("angle", [30, 45, 60])
def test_mixed_modes_fail_on_the_curve(start, angle, exponent):
    """Stiff blocks pulled at an angle, G_II = 2 G_I: nodes break where the rule says, within 3 %."""
    keys = SHAPES[0]
    normal, tangential = exact.Mode(keys, STRENGTH, TOUGHNESS), exact.Mode(keys, STRENGTH, 2.0 * TOUGHNESS)
    pull = Pull(
        start, f"constants.angle={angle}", f"contact.law.mixing.exponent={exponent}", "constants.height=4",
        "materials.block.E=1e4", "materials.block.density=1e-2",
    )  # fmt: skip
    s = pull.run.simulation
    breaks, directions = [], []
    while s.time < 1.2 and (s.contact.view.interfaces.means().area[0] > 0.0 or s.time < 0.1):
        s.step()
        c, j, ends = s.contact.contacts, s.contact.interfaces.jumps, s.contact.interfaces.ends
        if s.time > 0.1 and not breaks:
            means = s.contact.view.interfaces.means()
            directions.append(np.degrees(np.arctan2(means.jump_normal[0], means.jump_tangential[0])))
        # broken ones have no openings any more, those that break in the step have
        breaks_now = (j.history[: c.count, BREAKS] > 0.5) & (
            ends.now[: c.count].max(axis=1, initial=0.0) > 0.0
        )
        for k in np.flatnonzero(breaks_now):
            n, t = j.history[k, MOST_NORMAL], j.history[k, MOST_TANGENTIAL]
            shares = normal.spent(n) / normal.toughness, tangential.spent(t) / tangential.toughness
            breaks.append((c.geometry.area[k], shares[0] ** exponent + shares[1] ** exponent))
    area, sums = np.array(breaks).T
    assert area.sum() > 0.85 * AREA  # the rest breaks with particles that nodes share
    assert s.contact.view.interfaces.broken_area[0] == pytest.approx(AREA, rel=0.03)
    assert np.average(sums, weights=area) == pytest.approx(1.0, abs=0.03)
    assert np.abs(np.array(directions[20:]) - angle).max() < 3.0
    _, work = exact.work_of_mixed_failure(normal, tangential, np.radians(directions[-1]), exponent)
    assert s.contact.view.interfaces.cohesive_work[0] == pytest.approx(work * AREA, rel=0.03)
