"""What the particles of a running simulation show: arrays by identity, sums of momentum and energy."""

from typing import Any

import numpy as np

from mpmcli.solver.simulation import Simulation


def energy(s: Simulation) -> float:
    """Kinetic energy and stress work."""
    p = s.particles
    return float(0.5 * (p.mass * np.square(p.V).sum(axis=0)).sum() + p.stress_work.sum())


class ParticleSums:
    """Base of the runs of tests, which have a ``simulation``."""

    simulation: Simulation

    @property
    def s(self) -> Simulation:
        """The simulation, for short."""
        return self.simulation

    @property
    def particles(self) -> Any:
        """The particles, in the order of memory."""
        return self.simulation.particles

    def ordered(self, name: str) -> np.ndarray:
        """An array of the particles, ordered by identity."""
        return np.take(getattr(self.particles, name), np.argsort(self.particles.id), axis=-1)

    @property
    def momentum(self) -> np.ndarray:
        """Σ M V (d,)."""
        return np.asarray((self.particles.mass * self.particles.V).sum(axis=1))

    @property
    def momentum_of_parts(self) -> float:
        """Σ M |V|, against which errors of momentum are small."""
        return float((self.particles.mass * np.abs(self.particles.V).max(axis=0)).sum())

    @property
    def kinetic_energy(self) -> float:
        """½ Σ M V²."""
        return 0.5 * float((self.particles.mass * np.square(self.particles.V).sum(axis=0)).sum())

    @property
    def energy(self) -> float:
        """Kinetic energy and stress work."""
        return energy(self.simulation)

    @property
    def strain_energy(self) -> float:
        """Stored energy."""
        return float(np.sum(self.particles.vol0 * self.simulation.state.strain_energy_density()))

    def check_finite(self) -> None:
        """All that particles have is finite."""
        for name in ("X", "V", "F", "tau"):
            assert np.isfinite(getattr(self.particles, name)).all(), name
