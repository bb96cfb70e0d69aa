"""A straight line splits a block: particles see the nodes beyond it on a further side (``core.transfer.cut``)."""

from fractions import Fraction

import numpy as np
import pytest

from mpmcli.core.compiled.kernel import kernel, prange
from mpmcli.core.dofs import dof_of
from mpmcli.core.grid import Grid, unfold
from mpmcli.core.step import Step
from mpmcli.core.transfer import nodes
from mpmcli.core.transfer.cut import Cut
from mpmcli.core.transfer.full_mass import OrderRule, add_full_mass_increments
from mpmcli.core.transfer.kernels import move_particles, scatter
from mpmcli.core.transfer.stencil import fill
from mpmcli.solver import setup

WEIGHTS_OF_CUT = "Table(array"
"""Text of compiled code for product shape functions that also serves cut particles."""
FMPM4 = {"kind": "fmpm", "order": 4}
TILTED = (-40.0, -5.3, 40.0, 4.1)
STRAIGHT = (-40.0, -1.0, 40.0, -1.0)
"""Along a line of nodes, which are above it."""


def first_rows(particle, ranges):
    """First row of each band or chunk of particles, and the end, in the ascending list ``particle``."""
    return np.searchsorted(particle, ranges).astype(np.uint64)


def make_cut(transfer, particle, corner, S, G, side):
    """Rows of the particles (c,), by ascending place, on the sides ``side`` (c, m) of the nodes of their stencils."""
    p, grid, order = transfer.particles, transfer.grid, transfer.order
    node = corner[:, None] + transfer.stencil.offsets
    field = p.velocity_field[particle].astype(np.uint64)[:, None]
    dof = dof_of(node, field, side.astype(np.uint64), np.uint64(grid.node_count), np.uint64(grid.fields))
    mask = np.zeros(p.count, dtype=np.uint8)
    mask[particle] = 1
    bands, chunks = first_rows(particle, order.bands.first), first_rows(particle, order.chunks)
    return Cut(mask, particle, bands, chunks, corner, S, G, dof)


@kernel
def weigh_particles(shape, grid, across, X, F, size, stencil, chosen, ranges, corner, S, G):
    """Stencils of the particles ``chosen`` (c,), of which ``ranges`` has the first of each chunk and the end."""
    for c in prange(ranges.shape[0] - 1):
        slot = np.uint64(c)
        geometry = unfold(grid)
        for q in range(ranges[slot], ranges[slot + np.uint64(1)]):
            corner[q] = fill(
                shape, geometry, across, X, F, size, chosen[q], S[q], G[q], stencil.W[slot], stencil.status
            )


def weigh(transfer, F, chosen):
    """First nodes, values and gradients of the stencils of the particles ``chosen``."""
    p, m = transfer.particles, len(transfer.stencil.offsets)
    corner, S, G = (
        np.zeros(len(chosen), dtype=np.uint64),
        np.zeros((len(chosen), m)),
        np.zeros((len(chosen), 2 * m)),
    )
    weigh_particles[False](
        transfer.shape.parameters, transfer.geometry, transfer.across, p.X, F, p.size, transfer.stencil, chosen,
        first_rows(chosen, transfer.order.chunks), corner, S, G,
    )  # fmt: skip
    return corner, S, G


class Line:
    """A segment from (ax, ay) to (bx, by): a node is on side 1 of a particle if the segment is between them."""

    def __init__(self, grid, ax, ay, bx, by):
        self._grid, self._A, self._B = grid, np.array([[ax], [ay]]), np.array([[bx], [by]])

    def above(self, X):
        """On which side points (d, n) are; those on the line are above."""
        return self._side(self._A, self._B, X)

    def sorted(self):
        everywhere = np.arange(self._grid.node_count)
        return everywhere[self._distance(self._grid.coordinates(everywhere)) < 6.0 * self._grid.cell[0]]

    def find_cut(self, transfer, F):
        p = transfer.particles
        near = np.flatnonzero(self._distance(p.X) < 3.0 * self._grid.cell[0]).astype(np.uint64)
        corner, S, G = weigh(transfer, F, near)
        side = np.where(
            S > 0.0, self.sides(near, (corner[:, None] + transfer.stencil.offsets).astype(np.int64)), 0
        )
        rows = side.any(axis=1)
        return make_cut(transfer, near[rows], corner[rows], S[rows], G[rows], side[rows])

    def sides(self, particles, nodes):
        X = self.particles.X[:, particles.astype(np.int64)]
        return np.array([
            self._crosses(np.repeat(X[:, q : q + 1], nodes.shape[1], axis=1), self._grid.coordinates(nodes[q]))
            for q in range(len(particles))
        ]).reshape(nodes.shape)  # fmt: skip

    def _distance(self, X):
        along = (self._B - self._A) / np.linalg.norm(self._B - self._A)
        return np.abs(along[0] * (X[1] - self._A[1]) - along[1] * (X[0] - self._A[0]))

    @staticmethod
    def _side(P, Q, R):
        return (Q[0] - P[0]) * (R[1] - P[1]) - (Q[1] - P[1]) * (R[0] - P[0]) >= 0.0

    def _crosses(self, X, x):
        A, B = self._A, self._B
        return (self._side(A, B, X) != self._side(A, B, x)) & (self._side(X, x, A) != self._side(X, x, B))


@pytest.fixture
def split(block, monkeypatch):
    """Function: a run of the block, split by a line; its halves part from each other."""

    def make(line=None, keep=None, parallel=False, dt=0.02, **changes):
        original = setup.make_grid

        def with_sides(scene, plan):
            g = original(scene, plan)
            return Grid(
                g.lower, g.upper, g.cell, g.pad, g.width, g.fields, sides=2 if line and keep is None else 1
            )

        with monkeypatch.context() as patch:
            patch.setattr(setup, "make_grid", with_sides)
            run = block(time={"end": 1.0, "step": dt}, **changes)
        s, p = run.simulation, run.particles
        s.parallel = s.transfer.parallel = parallel
        if line is None:
            return run
        cut = Line(s.grid, *line)
        above = cut.above(p.X)
        p.V[:] = np.where(above, [[0.3], [0.4]], [[-0.2], [-0.3]]) + 0.1 * np.sin(p.X)
        if keep is None:
            cut.particles = p
            s.transfer.sights = cut
        else:
            s.remove_particles(above == keep)
        s.transfer.sort()
        return run

    return make


def fma(weight, value, total):
    """weight · value + total, rounded once, element by element."""
    one = np.frompyfunc(lambda a, b, c: float(Fraction(a) * Fraction(b) + Fraction(c)), 3, 1)
    return one(weight, value, total).astype(np.float64)


class Plain:
    """The sums of a run's particles over their sights, done plainly: particle by particle, node by node."""

    def __init__(self, run):
        s = run.simulation
        self.p, self.s, transfer, grid = s.particles, s, s.transfer, s.grid
        count, m = self.p.count, len(transfer.stencil.offsets)
        every = np.arange(count, dtype=np.uint64)
        corner, self.S, G = weigh(transfer, self.p.F, every)
        self.G = G.reshape(count, 2, m)
        node = (corner[:, None] + transfer.stencil.offsets).astype(np.int64)
        side = transfer.sights.sides(every, node) & (self.S > 0.0)
        self.dof = node + side * grid.node_count
        is_cut = side.any(axis=1)
        self.order = []
        bands = s.order.bands
        for b in bands.turn.astype(np.int64):
            mine = np.arange(bands.first[b], bands.first[b + 1], dtype=np.int64)
            self.order += [*mine[~is_cut[mine]], *mine[is_cut[mine]]]
        self.cut = np.flatnonzero(is_cut)

    def scatter(self, rows, out):
        """Add S times a row per particle, rounded as sums of products are."""
        for q in self.order:
            for S, i in zip(self.S[q], self.dof[q], strict=True):
                out[i] = fma(S, rows[q], out[i])
        return out

    def momenta(self):
        M, one = self.p.mass, np.ones(self.p.count)
        out = np.zeros((self.s.grid.dof_count, 3))
        for q in self.order:
            matter = np.array([one[q], *self.p.V[:, q]])
            for S, i in zip(self.S[q], self.dof[q], strict=True):
                out[i] = fma(S * M[q], matter, out[i])
        return out

    def forces(self):
        f, p = np.zeros((self.s.grid.dof_count, 2)), self.p
        for q in self.order:
            xx, yy, xy = (-p.vol0[q] * p.tau[row, q] for row in (0, 1, 3))
            for j, i in enumerate(self.dof[q]):
                f[i] = fma(self.G[q, 1, j], [xy, yy], fma(self.G[q, 0, j], [xx, xy], f[i]))
        return f

    def gathered(self, v, weights):
        """Σ w v over the sights of each particle, (N, 2)."""
        total = np.zeros((self.p.count, 2))
        for j in range(weights.shape[1]):
            total = fma(weights[:, j, None], v[self.dof[:, j]], total)
        return total

    def projected(self, v):
        return self.scatter(self.p.mass[:, None] * self.gathered(v, self.S), np.zeros_like(v))


def lumped(s):
    s.transfer.begin_step()
    s.transfer.extrapolate(s.velocity, with_forces=True)
    nodes.find_velocities[s.parallel](s.grid.active, s.velocity.zero, s.grid.mp, s.grid.f, s.arrays.v, None)


@pytest.mark.slow
@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("line", [TILTED, STRAIGHT], ids=["tilted", "along nodes"])
def test_every_sum_is_that_of_the_plain_reference_to_the_last_bit(line, parallel, split):
    """Extrapolation, forces, FMPM loop and gathers, where all particles have a table of weights (qcpdi)."""
    run = split(line, parallel=parallel, method={"shape": "qcpdi", "transfer": FMPM4, "update": "usl"})
    s, p = run.simulation, run.particles
    run.steps(2)
    p.tau[:] = np.random.default_rng(3).standard_normal(p.tau.shape)
    lumped(s)
    plain = Plain(run)
    assert 20 <= len(plain.cut) < p.count
    np.testing.assert_array_equal(s.transfer.cut.particle, plain.cut)
    mp = plain.momenta()
    np.testing.assert_array_equal(s.grid.mp, mp)
    np.testing.assert_array_equal(s.grid.f, plain.forces())
    m = mp[:, :1]
    inverse = np.divide(1.0, m, out=np.zeros_like(m), where=m > 0.0)
    dv = v = mp[:, 1:] * inverse
    for _ in range(3):
        dv = dv - plain.projected(dv) * inverse
        v = v + dv
    rule = OrderRule(4, lambda order: 1.0, None)
    add_full_mass_increments(s.velocity, s.transfer, Step(s.plan, 0.1, 0.0), rule, False)
    np.testing.assert_array_equal(s.arrays.v, v)
    dt, Sv, V, X = 0.01, plain.gathered(v, plain.S).T, p.V.copy(), p.X.copy()
    s.transfer.velocity_gradients(v)
    for a in range(2):
        np.testing.assert_array_equal(p.L[[a, 2 + a]], plain.gathered(v, plain.G[:, a]).T)
    s.transfer.move(v, None, None, False, 0.5, 0.0, dt, p.X, True, None, p.mass)
    A = (Sv - V) / dt
    np.testing.assert_array_equal(p.V, V + A * dt)
    np.testing.assert_array_equal(p.X, X + (V + 0.5 * A * dt) * dt)


@pytest.mark.slow
@pytest.mark.parametrize(
    "method",
    [
        {"shape": "ugimp", "transfer": FMPM4, "update": "usl"},
        {"shape": "lcpdi", "transfer": {"kind": "flip"}, "update": "usavg+"},
        {"shape": "b2gimp", "transfer": {"kind": "xpic", "order": 3}, "update": "usf"},
        {"shape": "lcpdi", "transfer": FMPM4 | {"velocity_gradient": True}, "update": "usl"},
        {"shape": "ugimp", "transfer": {"kind": "flip"}, "update": "usl", "volumetric": "averaged"},
    ],
    ids=lambda method: "-".join([method["shape"], method["transfer"]["kind"], method["update"]]),
)
@pytest.mark.parametrize("line", [TILTED, STRAIGHT], ids=["tilted", "along nodes"])
def test_the_halves_do_not_feel_each_other(line, method, split):
    """Whole steps of the split block are those of each half alone, but for the order of sums."""
    both = split(line, method=method).steps(12)
    whole = split(line, method=method)
    whole.simulation.transfer.sights = None
    whole.steps(12)
    apart = 0.0
    for keep in (True, False):
        alone = split(line, keep=keep, method=method).steps(12)
        ids = np.sort(alone.particles.id)
        assert 20 < len(ids) < 60
        for name in ("X", "V", "F", "tau"):
            expected = alone.ordered(name)
            scale = np.abs(expected).max()
            np.testing.assert_allclose(both.ordered(name)[..., ids], expected, rtol=0, atol=1e-12 * scale)
        apart = max(apart, np.abs(whole.ordered("V")[..., ids] - alone.ordered("V")).max())
    assert apart > 0.05, "without sights they do"
    grid = both.simulation.grid
    total = grid.sum_of_fields(grid.mp[:, 0])
    assert total.shape == (grid.node_count,)
    assert total.sum() == pytest.approx(both.particles.mass.sum(), rel=1e-13)
    assert grid.mp[: grid.node_count, 0].sum() < 0.97 * both.particles.mass.sum()


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["ugimp", "lcpdi"])
def test_serial_and_parallel_kernels_agree_to_the_last_bit(shape, split):
    method = {"shape": shape, "transfer": FMPM4, "update": "usl"}
    one, other = (
        split(TILTED, parallel=parallel, dt=0.004, method=method, grid__cell=0.25).steps(5)
        for parallel in (False, True)
    )
    assert len(one.simulation.order.bands.turn) > 2
    assert len(one.simulation.transfer.cut.particle) > 100
    for name in ("X", "V", "F", "tau"):
        np.testing.assert_array_equal(one.ordered(name), other.ordered(name))
    codes = [str(code.type_annotation) for code in scatter[False].overloads.values()]
    assert any(WEIGHTS_OF_CUT in code for code in codes if "Rows(" in code), (
        "what the next test looks for exists"
    )


def test_without_sights_no_array_and_no_code_for_them_exists(block):
    """Absent cut particles are None: the branches that serve them are pruned, and with them the sums over tables."""
    s = block().steps(2).simulation
    assert s.transfer.cut is None
    assert s.transfer.sights is None
    assert s.grid.sides == 1
    assert s.grid.dof_count == s.grid.used_dofs == s.grid.node_count
    for each in (scatter, move_particles):
        found = each[False].overloads.items()
        codes = [str(code.type_annotation) for types, code in found if "Cut(" not in str(types)]
        of_products = [code for code in codes if "Rows(" in code]
        assert of_products
        assert not any(WEIGHTS_OF_CUT in code for code in of_products)
