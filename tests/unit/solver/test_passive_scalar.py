"""A scalar that particles carry to the grid runs through the full-mass loop of velocities, on moving bodies."""

import numpy as np
import pytest

from mpmcli.core.step import Step
from mpmcli.core.transfer import nodes
from mpmcli.core.transfer.full_mass import OrderRule, add_filtered_values, add_full_mass_increments
from mpmcli.core.transfer.nodal_field import Correction, NodalField

CASES = [
    ("bar", "lcpdi"),
    *(
        pytest.param(*case, marks=pytest.mark.slow)
        for case in [("bar", "ugimp"), ("block", "ugimp"), ("block", "lcpdi")]
    ),
]


class Scalar:
    """A scalar of the particles of a run, whose capacity is mass times a factor of each particle, and its matrices."""

    def __init__(self, run, find_stencils):
        self.s = s = run.simulation
        p = s.particles
        rng = np.random.default_rng(7)
        self._value, self._factor = rng.uniform(1.0, 3.0, p.count), rng.uniform(0.5, 4.0, p.count)
        n = s.grid.dof_count
        self.field = NodalField(
            "scalar",
            (0.0,),
            s.grid,
            self.capacity,
            self.carried,
            np.zeros((n, 2)),
            np.zeros((n, 1)),
            np.zeros((n, 1)),
        )
        self.field.allocate_loop(is_dynamic=True)
        s.transfer.fields.append(self.field)
        run.steps(4)
        s.transfer.begin_step()
        S, _ = find_stencils(s.plan.shape.name, s.grid, p.X, p.size, p.F).matrices()
        C = S.T @ self.capacity()
        self.seen = C > 1e-9 * C.max()
        self.S, self.C = S[:, self.seen], C[self.seen]
        self.plus = self.S.T * self.capacity() / self.C[:, None]
        self.passes = self.plus @ self.S

    def capacity(self):
        return self.s.particles.mass * self._factor[self.s.particles.id]

    def carried(self):
        return self._value[self.s.particles.id][None]

    def lumped(self):
        """The field with its lumped values v⁺(1)."""
        s, field = self.s, self.field
        s.transfer.extrapolate(field)
        nodes.find_velocities[s.parallel](s.grid.active, field.zero, field.mp, field.f, field.v, None)
        return field

    def after_loop(self, rule):
        """Values v⁺(k) at the nodes with capacity, and the order that the loop reached."""
        field = self.lumped()
        order = add_full_mass_increments(field, self.s.transfer, Step(self.s.plan, 0.1, 0.0), rule, False)
        return field.v[self.seen, 0], order


@pytest.fixture(scope="module")
def scalar(request, find_stencils):
    """Function: the scalar of a run of ``bar`` or ``block`` with a shape function, made once."""
    made = {}

    def make(body, shape):
        if (body, shape) not in made:
            run = request.getfixturevalue(body)(
                method={"shape": shape, "transfer": {"kind": "fmpm", "order": 4}}
            )
            made[body, shape] = Scalar(run, find_stencils)
        return made[body, shape]

    return make


def rule(order, dynamic=None, scale=lambda order: 1.0):
    return OrderRule(order, scale, dynamic)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
@pytest.mark.parametrize(("body", "shape"), CASES)
def test_the_loop_gives_the_sum_of_powers(body, shape, order, scalar):
    """v⁺(k) = Σ_{l<k} (1 − S⁺S)^l S⁺ T with the capacity-weighted S⁺ = C⁻¹ Sᵀ diag(M c) (Nairn 2026, Eq. 6)."""
    q = scalar(body, shape)
    found, reached = q.after_loop(rule(order))
    dv = expected = q.plus @ q.carried()[0]
    for _ in range(order - 1):
        dv = dv - q.passes @ dv
        expected = expected + dv
    assert reached == order
    assert np.ptp(expected) > 0.1
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def test_a_constant_stays_constant(scalar):
    q = scalar("bar", "lcpdi")
    kept, q._value = q._value, np.full_like(q._value, 2.5)
    found, _ = q.after_loop(rule(4))
    q._value = kept
    np.testing.assert_allclose(found, 2.5, rtol=0, atol=1e-12)


def test_orders_blend_and_end_early(scalar):
    q = scalar("bar", "lcpdi")
    second, _ = q.after_loop(rule(2))
    np.testing.assert_array_equal(q.after_loop(rule(5, scale=lambda order: float(order < 3)))[0], second)
    assert q.after_loop(rule(9, ("means", 1e3)))[1] == 2
    assert 2 < q.after_loop(rule(50, ("means", 0.02)))[1] < 50


def test_the_filter_takes_the_same_field(scalar):
    """u = Σ_{j<m} (1 − S⁺S)ʲ v⁰ + (1 − S⁺S)^(m−1) (v − v⁰), here with v = v⁰ (Nairn et al. 2020, Eq. 37)."""
    q = scalar("bar", "lcpdi")
    field, w = q.lumped(), np.zeros_like(q.field.v)
    add_filtered_values(field, q.s.transfer, Step(q.s.plan, 0.1, 0.0), 3, field.mp[:, 1:].copy(), w, None)
    expected, u0 = field.v[q.seen, 0], field.v[q.seen, 0]
    for _ in range(2):
        expected = u0 + expected - q.passes @ expected
    np.testing.assert_allclose(w[q.seen, 0], expected, rtol=0, atol=1e-13 * np.abs(expected).max())


class Log(Correction):
    """Writes down when it is called; holds the value at a node."""

    def __init__(self, name, calls, node):
        self.name, self.calls, self.node = name, calls, node

    def complete(self, sums, weight):
        self.calls.append((self.name, "complete", weight))

    def correct(self, step, dv, counts_reactions):
        self.calls.append((self.name, "correct", step.dt))
        dv[self.node] = 0.0


def test_corrections_act_on_sums_and_increments_in_their_order(scalar):
    q, calls = scalar("bar", "lcpdi"), []
    node = int(np.flatnonzero(q.seen)[3])
    q.field.corrections = [Log("first", calls, node), Log("second", calls, node)]
    lumped = q.lumped().v.copy()
    step = Step(q.s.plan, 0.1, 0.0)
    add_full_mass_increments(q.field, q.s.transfer, step, rule(3), counts_reactions=True)
    q.field.corrections = []
    order = [
        (name, what, number)
        for what, number in (("complete", -1.0), ("correct", 0.1))
        for name in ("first", "second")
    ]
    assert calls == order * 2
    assert q.field.v[node] == lumped[node]
    assert not np.array_equal(q.field.v, lumped)


def test_nodes_that_fall_out_of_use_are_emptied(scalar):
    """A sort clears every field that particles carry, not only momentum."""
    q = scalar("bar", "lcpdi")
    q.lumped()
    s, before = q.s, q.field.mp[:, 0].sum()
    assert before > 0.0
    s.transfer.sort()
    assert not q.field.mp.any()
