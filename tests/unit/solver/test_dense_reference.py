"""One whole step against matrices: V⁺ and X⁺ of every transfer, from S and G of the particles."""

import numpy as np
import pytest

METHODS = {
    "flip": {"kind": "flip", "alpha": 0.25},
    "pic": {"kind": "fmpm", "order": 1},
    "fmpm5": {"kind": "fmpm", "order": 5, "alpha": 0.25},
    "xpic1": {"kind": "xpic", "order": 1},
    "xpic2": {"kind": "xpic", "order": 2},
    "xpic5": {"kind": "xpic", "order": 5, "alpha": 0.25},
}


@pytest.fixture(scope="module")
def dense(find_stencils):
    """Function: (S, S⁺, nodal accelerations of the internal forces) of a run's particles, on nodes with mass."""

    def make(run):
        s, p = run.simulation, run.particles
        S, G = find_stencils(s.plan.shape.name, s.grid, p.X, p.size, p.F).matrices()
        m = S.T @ p.mass
        seen = m > 0
        S, G, m = S[:, seen], G[:, :, seen], m[seen]
        tau = np.array([[p.tau[0], p.tau[3]], [p.tau[3], p.tau[1]]])
        f = -np.einsum("p,abp,bpn->na", p.vol0, tau, G)
        return S, S.T * p.mass / m[:, None], f / m[:, None]

    return make


@pytest.mark.parametrize("loaded", [False, True], ids=["without stress", "with stress"])
@pytest.mark.parametrize("method", METHODS)
def test_a_step_is_what_the_matrices_say(method, loaded, block, dense):
    """XPIC(m): V⁺ = (1 − (1 − SS⁺)^m) V + S a Δt (Nairn et al. 2020, Eq. 36); FMPM(k): V⁺ = S Σ_{l<k}(1 − S⁺S)^l v⁺."""
    transfer = METHODS[method]
    run = block(method__transfer=transfer, time={"end": 1, "step": 0.004})
    p = run.particles
    rng = np.random.default_rng(11)
    p.V[:] = rng.standard_normal(p.V.shape)
    if loaded:
        p.tau[:] = rng.standard_normal(p.tau.shape)
    S, plus, a = dense(run)
    V, X, dt = p.V.T.copy(), p.X.T.copy(), 0.004
    order, alpha = transfer.get("order", 1), transfer.get("alpha", 0.5)
    one = np.eye(len(V))
    if transfer["kind"] == "flip":
        A = S @ a
        U = S @ (plus @ V)
    elif transfer["kind"] == "xpic":
        filtered = (one - np.linalg.matrix_power(one - S @ plus, order)) @ V
        A, U = (filtered + S @ a * dt - V) / dt, V
    else:
        dv = v = plus @ V + a * dt
        for _ in range(order - 1):
            dv = dv - plus @ (S @ dv)
            v = v + dv
        A, U = (S @ v - V) / dt, V
    run.simulation.step()
    np.testing.assert_allclose(p.V.T, V + A * dt, rtol=0, atol=1e-12)
    np.testing.assert_allclose(p.X.T, X + (U + alpha * A * dt) * dt, rtol=0, atol=1e-12)


def test_without_forces_fmpm_and_xpic_are_one(block):
    """(1 − (1 − SS⁺)^k) V both ways."""
    after = []
    for kind in ("fmpm", "xpic"):
        run = block(method__transfer={"kind": kind, "order": 3})
        run.particles.V[:] = np.random.default_rng(4).standard_normal(run.particles.V.shape)
        run.simulation.step()
        after.append(run.particles.V)
    np.testing.assert_allclose(*after, rtol=0, atol=1e-12)


def test_gradients_use_the_same_velocity_as_the_motion(block, find_stencils):
    """F⁺ = exp(L Δt) F with L = G v⁺(k), to second order in Δt."""
    run = block(method__transfer={"kind": "fmpm", "order": 3}, time={"end": 1, "step": 1e-5})
    s, p = run.simulation, run.particles
    p.V[:] = np.random.default_rng(5).standard_normal(p.V.shape)
    _, G = find_stencils("ugimp", s.grid, p.X, p.size).matrices()
    s.step()
    L = np.einsum("na,bpn->abp", s.arrays.v, G).reshape(4, -1)
    np.testing.assert_allclose(p.L[:4], L, atol=1e-12)
    np.testing.assert_allclose((p.F[:4] - np.array([[1], [0], [0], [1.0]])) / 1e-5, L, atol=1e-3)
