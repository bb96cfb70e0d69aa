"""What the verification tests share: scenes run to an end, and what the particles of a run show."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from particle_sums import ParticleSums

from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

INPUTS = Path(__file__).parents[2] / "inputs"


class Run(ParticleSums):
    """A simulation with shorthand for what verification looks at; arrays are ordered by particle identity."""

    def __init__(self, source: str, sets: tuple[str, ...], threads: int | None):
        scene = source if "\n" in source else INPUTS / source
        self.simulation = Simulation(load_scene(scene, sets=sets), threads)
        self.X0 = self.X

    def to(self, end: float, each: Callable[[Run], Any] | None = None) -> list[Any]:
        """Step until the time ``end`` is reached; what ``each`` returned after every step."""
        seen = []
        while self.time < end * (1.0 - 1e-12):
            self.simulation.step()
            if each is not None:
                seen.append(each(self))
        return seen

    @property
    def time(self) -> float:
        """Time of the state."""
        return self.simulation.time

    def received(self, name: str) -> np.ndarray:
        """``heat_inflow`` or ``entropy`` of the particles, ordered by identity, per radian if axisymmetric."""
        snapshot = Snapshot(self.simulation.state)
        return getattr(snapshot, name)[snapshot.order] / snapshot.full_ring

    @property
    def X(self) -> np.ndarray:
        """Positions (d, N)."""
        return self.ordered("X")

    @property
    def V(self) -> np.ndarray:
        """Velocities (d, N)."""
        return self.ordered("V")

    @property
    def J(self) -> np.ndarray:
        """det F (N,)."""
        return self.particles.determinant()[np.argsort(self.particles.id)]

    @property
    def stress(self) -> np.ndarray:
        """Cauchy stress, rows as in ``analysis.STRESS_COMPONENTS``."""
        return self.ordered("tau") / self.J

    @property
    def mass(self) -> np.ndarray:
        """Masses (N,)."""
        return self.ordered("mass")

    @property
    def stress_work(self) -> float:
        """Accumulated work of the stress."""
        return float(self.particles.stress_work.sum())


@pytest.fixture(scope="session")
def start():
    """Function (file name in inputs/ or YAML text, *sets, threads=None) → ``Run``."""

    def make(source: str, *sets: str, threads: int | None = None) -> Run:
        return Run(source, sets, threads)

    return make
