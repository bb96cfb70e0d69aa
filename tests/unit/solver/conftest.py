"""Small scenes as dictionaries, run by the real solver with serial kernels."""

from __future__ import annotations

from typing import Any

import pytest
import yaml
from particle_sums import ParticleSums
from scene_problems import with_keys

from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SOFT = {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}

BLOCK: dict[str, Any] = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-8, -8], "upper": [8, 8], "cell": 1},
    "method": {"shape": "ugimp", "update": "usl", "transfer": {"kind": "flip"}},
    "materials": {"soft": SOFT},
    "bodies": [
        {
            "name": "block",
            "material": "soft",
            "region": {"kind": "box", "lower": [-2, -3], "upper": [3, 1]},
            "velocity": ["0.4 - 0.2*x + 0.1*y", "0.3 + 0.1*x"],
        }
    ],
    "time": {"end": 1.0, "courant": 0.2},
}
"""A block of 80 particles that flies, turns and is pressed together (plane strain)."""

BAR: dict[str, Any] = {
    "version": 1,
    "analysis": {"kind": "uniaxial_stress"},
    "grid": {"lower": [0], "upper": [25], "cell": 1},
    "method": {"shape": "lcpdi", "update": "usl", "transfer": {"kind": "fmpm", "order": 4}},
    "materials": {"elastic": {"kind": "linear_elastic", "density": 0.5, "E": 2.0, "nu": 0.0}},
    "bodies": [
        {
            "name": "bar",
            "material": "elastic",
            "region": {"kind": "box", "lower": [0], "upper": [20]},
            "velocity": ["0.08*sin(pi*x/40)"],
        }
    ],
    "boundary": [
        {
            "name": "support",
            "kind": "velocity",
            "on": {"plane": {"axis": "x", "at": 0}},
            "direction": "x",
            "value": 0,
        }
    ],
    "time": {"end": 40.0, "courant": 0.2},
}
"""A quarter period of a freely vibrating bar (Nairn 2026, section 3.3)."""


class Run(ParticleSums):
    """A simulation with the bookkeeping of its energies."""

    def __init__(self, scene: dict[str, Any], threads: int | None = None):
        self.loaded = load_scene(yaml.safe_dump(scene))
        self.simulation = Simulation(self.loaded, threads=threads)
        self.balance = EnergyBalance()
        self.error = 0.0
        self.look()

    def look(self) -> Snapshot:
        """Take the state into account."""
        snapshot = Snapshot(self.simulation.state)
        self.error = max(self.error, abs(self.balance.update(snapshot)))
        return snapshot

    def steps(self, count: int) -> Run:
        """Take some steps."""
        for _ in range(count):
            self.simulation.step()
            self.look()
        return self

    def until(self, time: float) -> Run:
        """Run to a time."""
        while self.simulation.time < time:
            self.simulation.step()
            self.look()
        return self

    @property
    def angular_momentum(self) -> float:
        p = self.particles
        return float((p.mass * (p.X[0] * p.V[1] - p.X[1] * p.V[0])).sum())


@pytest.fixture(scope="session")
def block():
    """Function: a run of the block with changes to its scene (``method__update="usf"``)."""
    return lambda threads=None, **changes: Run(with_keys(BLOCK, **changes), threads)


@pytest.fixture(scope="session")
def bar():
    """Function: a run of the vibrating bar with changes to its scene."""
    return lambda threads=None, **changes: Run(with_keys(BAR, **changes), threads)
