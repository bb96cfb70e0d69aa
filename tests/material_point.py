"""One particle of a material under velocity gradients of our choice: the loop over particles, without a grid."""

import math
from typing import Any

import numpy as np
from particles_at import particles_at

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.particles import Particles
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import history_at_start
from mpmcli.materials.strain import block_count, stored_energy, update_strain_and_stress


def particles_of(
    model: Any, analysis: Any, count: int = 1, volume: float = 1.0, is_viscous: bool = False
) -> Particles:
    """Particles of a material as they are at the start."""
    particles = particles_at(
        analysis, np.zeros((analysis.dimensions, count)), 1.0, volume, volume * model.density,
        history_rows=max(1, len(model.history)), artificial_viscosity=is_viscous,
    )  # fmt: skip
    particles.H[:] = history_at_start(model, count)
    return particles


class MaterialPoint:
    """A particle of initial volume 1.

    Parameters
    ----------
    analysis : by name
    words : of the material
    adiabatic : heat stays where it arises
    bands : widths along x, y and z in which strain can localise
    """

    def __init__(
        self,
        analysis: str,
        words: dict[str, Any],
        adiabatic: bool = False,
        bands: tuple[float, float, float] = (1, 1, 1),
    ):
        self.model: Any = MATERIALS[words["kind"]].model_validate({"density": 1.0} | words)
        self.analysis = ANALYSES[analysis]()
        self.m = self.model.parameters(analysis, adiabatic)
        self.particles = p = particles_of(self.model, self.analysis)
        for name, size in zip(self.model.bands, bands, strict=False):
            p.H[self.model.history.index(name)] = size
        self._speed2 = np.zeros(block_count(1))
        self._bad = np.zeros(block_count(1), dtype=np.int64)
        self.time = 0.0

    def step(self, dt: float, *L: float) -> np.ndarray:
        """One step with a velocity gradient, all components or one of them; returns the Kirchhoff stress."""
        p = self.particles
        for row, value in enumerate(L):
            p.L[row] = value
        update_strain_and_stress[False](
            self.analysis, self.m, 0, p.F, p.L, p.tau, p.H, p.mass, p.vol0, p.material, p.stress_work, None, None,
            (0.0, math.inf), self._speed2, self._bad, np.zeros(2), dt,
        )  # fmt: skip
        assert self._bad[0] == -1
        self.time += dt
        return self.tau

    def steps(self, count: int, dt: float, *L: float) -> np.ndarray:
        """Several of them."""
        for _ in range(count):
            self.step(dt, *L)
        return self.tau

    @property
    def tau(self) -> np.ndarray:
        """Kirchhoff stress, its stored components [pressure]."""
        return self.particles.tau[:, 0].copy()

    @property
    def F(self) -> np.ndarray:
        """Deformation gradient, its stored components."""
        return self.particles.F[:, 0].copy()

    @property
    def J(self) -> float:
        """Relative volume."""
        return float(self.particles.determinant()[0])

    @property
    def work(self) -> float:
        """Work of the stress [energy]."""
        return float(self.particles.stress_work[0])

    @property
    def energy(self) -> float:
        """Stored energy [energy]."""
        p, out = self.particles, np.zeros(1)
        stored_energy[False](self.analysis, self.m, 0, p.F, p.H, p.material, None, out)
        return float(out[0])

    def history(self, name: str) -> float:
        """A history variable."""
        return float(self.particles.H[self.model.history.index(name), 0])
