"""A cloud of deformed particles in motion on a small grid, with the transfer kernels bound to it."""

import numpy as np
import pytest
from particles_at import particles_at

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.chunks import CHUNKS
from mpmcli.core.grid import Grid
from mpmcli.core.order import CellOrder
from mpmcli.core.transfer import kernels as transfer
from mpmcli.core.transfer.stencil import across_of, allocate_stencil, kept_as
from mpmcli.shapes import SHAPES


class Cloud:
    """Random particles, sorted by cell, and the operators of ``core.transfer.kernels`` on them."""

    def __init__(
        self, analysis: str, shape: str, count: int = 60, seed: int = 1, cells=(6, 9, 5), parallel=False
    ):
        rng = np.random.default_rng(seed)
        self.name, self.parallel = shape, parallel
        self.analysis = ANALYSES[analysis]()
        d = self.analysis.dimensions
        self.shape = SHAPES[shape]
        self.parameters = self.shape.parameters
        cell = np.array([0.5, 0.8, 1.25])[:d]
        lower = np.array([0.0, -1.0, 0.3])[:d]
        upper = lower + np.array(cells)[:d] * cell
        self.grid = Grid(lower, upper, cell, self.shape.pad, self.shape.width)
        X = lower[:, None] + (0.02 + 0.96 * rng.random((d, count))) * (upper - lower)[:, None]
        vol0 = rng.uniform(0.5, 1.5, count) * np.prod(cell) / 4
        self.particles = p = particles_at(self.analysis, X, 0.25 * cell, vol0, rng.uniform(0.5, 2.0, count))
        p.V[:] = rng.standard_normal(p.V.shape)
        p.tau[:] = rng.standard_normal(p.tau.shape)
        p.F[: d * d] += rng.uniform(-0.15, 0.15, (d * d, count))
        self.order = CellOrder(p, self.grid)
        self.widen(self.grid.width)

    def widen(self, width: int) -> None:
        """Sort, with stencils that span ``width`` nodes per axis."""
        self.grid.width = width
        self.order.sort(self.parallel)
        self.stencil = allocate_stencil(self.dimensions, width, self.grid.offsets(), self.order.slots)
        self.across = across_of(width)

    @property
    def dimensions(self) -> int:
        return self.analysis.dimensions

    def operator(self, ranges):
        """The arguments that all transfer kernels share, for bands or chunks of particles."""
        p = self.particles
        return (
            self.analysis,
            self.parameters,
            self.grid.geometry,
            self.across,
            ranges,
            self.stencil,
            p.X,
            p.F,
            p.size,
            None,
            None,
        )

    def keep_weights(self) -> None:
        """From now on weights are read from memory, as in later passes of the FMPM loop."""
        kept, count = kept_as(self.parameters), self.particles.count
        columns = kept.columns(self.grid.width, self.dimensions)
        stored = kept(np.zeros(count, dtype=np.uint64), np.zeros((count, columns)))
        _, *operator, _, _ = self.operator(self.order.chunks)
        transfer.store_weights[self.parallel](*operator, *stored)
        self.parameters = stored

    def scatter(self, task, components: int | None = None):
        """Run a scatter task of ``core.transfer.kernels``, of a quantity with as many components."""
        zero = (0.0,) * (components or self.dimensions)
        transfer.scatter[self.parallel](task, zero, None, *self.operator(self.order.bands))

    def nodal(self, components: int | None = None) -> np.ndarray:
        return np.zeros((self.grid.node_count, components or self.dimensions))

    def mass_and_momentum(self) -> np.ndarray:
        mp = self.nodal(1 + self.dimensions)
        self.scatter(transfer.MassAndMomentum(self.particles.mass, self.particles.V, mp.reshape(-1)))
        return mp

    def forces(self) -> np.ndarray:
        f = self.nodal()
        self.scatter(transfer.InternalForces(self.particles.vol0, self.particles.tau, f.reshape(-1)))
        return f

    def momenta_of_pass(self, v: np.ndarray) -> np.ndarray:
        """Sᵀ M S v."""
        out = self.nodal()
        self.scatter(transfer.Projection(self.particles.mass, v.reshape(-1), out.reshape(-1)))
        return out

    def project(self, v: np.ndarray) -> np.ndarray:
        """S⁺S v, zero where no mass is."""
        out = self.momenta_of_pass(v)
        m = self.mass_and_momentum()[:, :1]
        return np.divide(out, m, out=np.zeros_like(out), where=m > 0)

    def find_gradients(self, v: np.ndarray) -> None:
        """L = G v of all particles."""
        operator = self.operator(self.order.chunks)
        zero = (0.0,) * v.shape[1]
        transfer.find_velocity_gradients[self.parallel](zero, *operator, v.reshape(-1), self.particles.L)

    def move(self, v, w, flip, alpha=0.5, damping=0.0, dt=0.01, damped=None, L=True):
        """Move the particles; returns what the kernel reports per chunk."""
        p = self.particles
        report = {
            "speed2": np.zeros(CHUNKS),
            "travel": np.zeros(CHUNKS),
            "outside": np.zeros(CHUNKS, dtype=np.int64),
        }
        bounds = np.stack([self.grid.lower, self.grid.upper], axis=1)
        transfer.move_particles[self.parallel](
            *self.operator(self.order.chunks), v.reshape(-1), None if w is None else w.reshape(-1), None,
            True if flip else None, p.V, p.X, p.L if L else None, p.mass, report["speed2"], report["travel"],
            report["outside"], np.zeros(3), bounds, damped, None, alpha, damping, dt,
        )  # fmt: skip
        return report


@pytest.fixture(scope="session")
def cloud():
    """The class ``Cloud``: (analysis, shape, count=60, seed=1, …)."""
    return Cloud


@pytest.fixture(scope="session")
def dense_of(find_stencils):
    """Function: the matrices S (N, n) and G (d, N, n) of a cloud, by ``find_stencils``."""

    def dense(cloud):
        p = cloud.particles
        return find_stencils(cloud.name, cloud.grid, p.X, p.size, p.F).matrices()

    return dense
