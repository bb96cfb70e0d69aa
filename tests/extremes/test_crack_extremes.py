"""Cracks at their limits: finite, momentum kept, no energy made, and what is left out is counted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import yaml
from particle_sums import ParticleSums

from mpmcli.core.errors import SimulationError
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

pytestmark = pytest.mark.slow

FLIP, FMPM = {"kind": "flip"}, {"kind": "fmpm", "order": 4}
every_way = pytest.mark.parametrize("transfer", [FLIP, FMPM], ids=["flip", "fmpm4"])
SOFT: dict[str, Any] = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}
FRICTION = {"kind": "coulomb", "friction": 0.3}
STEPS = 200


def crack(points: Any, name: str = "c", mouths: str = "", **more: Any) -> dict[str, Any]:
    """A crack; ``mouths`` names its ends that are mouths."""
    ends = dict.fromkeys(mouths.split(), "mouth")
    path = {"kind": "points", "points": np.array(points, dtype=float).tolist()}
    return {"name": name, "path": path, "ends": ends, "faces": {"law": FRICTION}, **more}


class CrackedRun(ParticleSums):
    """A block of ten by ten cells with cracks, that shakes, turns and flies."""

    def __init__(self, cracks: list[dict[str, Any]], transfer: dict[str, Any] = FLIP, **changes: Any):
        body = {
            "name": "block",
            "material": "soft",
            "region": {"kind": "box", "lower": [-5, -5], "upper": [5, 5]},
            "velocity": ["0.3 + 0.5*sin(0.7*y) - 0.05*y", "0.1 + 0.5*cos(0.9*x)*sin(0.6*y) + 0.05*x"],
        }
        scene: dict[str, Any] = {
            "version": 1,
            "analysis": {"kind": "plane_strain"},
            "grid": {"lower": [-12, -12], "upper": [12, 12], "cell": 1},
            "method": {"shape": "ugimp", "transfer": transfer},
            "materials": {"soft": SOFT},
            "bodies": [body],
            "cracks": cracks,
            "time": {"end": 1000.0, "courant": 0.2},
        }
        scene |= changes
        self.simulation = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)
        self.start, self.initial = self.momentum, self.total
        self.scale = self.momentum_of_parts
        self.highest = self.initial

    def steps(self, count: int = STEPS) -> CrackedRun:
        """Take steps; keep the largest energy."""
        for _ in range(count):
            self.s.step()
        self.highest = max(self.highest, self.total)
        return self

    @property
    def total(self) -> float:
        """Kinetic and strain energy."""
        return self.kinetic_energy + self.strain_energy

    def check(self, energy: float = 1.02) -> None:
        """Finite, momentum kept, no energy made."""
        self.check_finite()
        for chain in self.s.cracks.chains:
            assert np.isfinite(chain.faces).all()
        assert np.abs(self.momentum - self.start).max() < 1e-11 * self.scale
        assert self.highest < energy * self.initial


TIPS = {
    "node": (1.0, 1.0),
    "particle": (1.25, 0.75),
    "edge of a cell": (1.0, 0.37),
    "corner of a particle": (1.5, 0.5),
}


@every_way
@pytest.mark.parametrize("where", list(TIPS))
def test_a_tip_at(where, transfer):
    run = CrackedRun([crack([TIPS[where], (-3.1, -0.4)])], transfer).steps()
    run.check()
    assert run.s.cracks.view.nodes > 0


@every_way
@pytest.mark.parametrize("line", [0.0, 0.25, 0.5, 1e-9])
def test_a_crack_along_a_row(line, transfer):
    """Along nodes, along particles, between particles, hardly beside nodes."""
    CrackedRun([crack([(-3, line), (3, line)])], transfer).steps().check()
    CrackedRun([crack([(line, -6), (line, 6)], mouths="start end")], transfer).steps().check()


@every_way
@pytest.mark.parametrize("size", [0.9, 0.3, 0.05])
def test_a_crack_shorter_than_a_cell(size, transfer):
    path = np.array([[0.0, 0.0], [0.8, 0.6]]) * size + [0.13, 0.21]
    CrackedRun([crack(path, spacing=0.25 * size)], transfer).steps().check()


@every_way
def test_two_hundred_cracks(transfer):
    """Of random places, lengths and directions; three at a node are counted."""
    rng = np.random.default_rng(3)
    cracks, tips = [], np.zeros((0, 2))
    while len(cracks) < 200:
        middle, angle = rng.uniform(-3.8, 3.8, 2), rng.uniform(0, np.pi)
        half = rng.uniform(0.2, 1.0) * np.array([np.cos(angle), np.sin(angle)])
        ends = np.stack([middle - half, middle + half])
        if not len(tips) or np.hypot(*(tips[:, None] - ends).T).min() > 0.06:
            cracks.append(crack(ends, name=f"c{len(cracks)}", spacing=0.05))
            tips = np.vstack([tips, ends])
    run = CrackedRun(cracks, transfer).steps(100)
    run.check()
    assert run.s.cracks.view.all_third > 0


@every_way
@pytest.mark.parametrize("distance", [0.5, 0.1])
def test_two_cracks_side_by_side(distance, transfer):
    """The matter between them is at most a row of particles."""
    pair = [
        crack([(-3, y), (3, y + 0.02)], name=name, spacing=0.1)
        for name, y in (("a", 0.1), ("b", 0.1 + distance))
    ]
    CrackedRun(pair, transfer).steps().check()


@every_way
def test_a_corner_of_one_particle(transfer):
    """A chip that leaves with its own momentum."""
    run = CrackedRun([crack([(4.3, 5.6), (5.6, 4.3)], mouths="start end")], transfer)
    run.steps()
    run.check()


@every_way
def test_cracks_that_cross_many_times(transfer):
    """A comb: five across three."""
    lines = [crack([(-4, y), (4, y + 0.1)], name=f"a{k}") for k, y in enumerate((-3, -1, 0, 1, 3))]
    lines += [crack([(x, -4), (x + 0.1, 4)], name=f"b{k}") for k, x in enumerate((-2.2, 0.3, 2.4))]
    CrackedRun(lines, transfer).steps().check()


@every_way
@pytest.mark.parametrize("ratio", [1e6, 1e-6])
def test_bodies_of_other_stiffness_that_a_crack_divides(ratio, transfer):
    halves = [
        {"name": "low", "material": "soft", "region": {"kind": "box", "lower": [-5, -5], "upper": [5, 0]}},
        {"name": "high", "material": "other", "region": {"kind": "box", "lower": [-5, 0], "upper": [5, 5]}},
    ]
    speeds = (["0.2*sin(0.7*y)", 0.1], ["0.1", "-0.1"])
    bodies = [half | {"velocity": speed} for half, speed in zip(halves, speeds, strict=True)]
    materials = {"soft": SOFT, "other": SOFT | {"E": SOFT["E"] * ratio}}
    run = CrackedRun(
        [crack([(-6, 0), (6, 0)], mouths="start end")], transfer, bodies=bodies, materials=materials
    )
    run.steps(300).check()


def test_high_orders():
    """FMPM of order 20, with a step that it is stable at."""
    order = {"kind": "fmpm", "order": 20}
    run = CrackedRun([crack([(-3, 0.2), (3, 0.7)])], order, time={"end": 1000.0, "courant": 0.04})
    run.steps().check()


@every_way
def test_matter_torn_off_stops_the_run_or_goes(transfer):
    """A half that leaves fast enough moves by more than half a cell a step, which the run tells with the crack."""
    body = {
        "name": "block",
        "material": "soft",
        "region": {"kind": "box", "lower": [-5, -5], "upper": [5, 5]},
        "velocity": [0, "where(y > 0, 2000, 0)"],
    }
    cut = crack([(-6, 0), (6, 0)], name="cut", mouths="start end")
    with pytest.raises(SimulationError):
        CrackedRun([cut], transfer, bodies=[body], time={"end": 1.0, "step": 0.001}).steps(50)
