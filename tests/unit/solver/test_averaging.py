"""Volume averaging: the step against matrices, the balance of energy, symmetry, and what it leaves alone."""

import numpy as np
import pytest

pytestmark = pytest.mark.slow

AVERAGED = {"method__volumetric": "averaged"}
TIGHT = {"materials__soft": {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.49}}
ROOM = 1e-11
"""Round-off, in units of stress and velocity gradient."""


def average(S: np.ndarray, weight: np.ndarray, values: np.ndarray) -> np.ndarray:
    """S of the weighted means on nodes; ``S`` (N, n) has a column per node with mass."""
    return S @ ((S.T @ (weight * values)) / (S.T @ weight))


@pytest.mark.parametrize("update", ["usl", "usl+"])
@pytest.mark.parametrize("shape", ["ugimp", "lcpdi"])
def test_a_step_is_what_the_matrices_say(block, find_stencils, shape, update):
    """FLIP: ΔV = S a Δt from averaged mean stresses; F grows by gradients whose trace is averaged."""
    dt = 1e-6
    run = block(
        method__shape=shape, method__update=update, method__volumetric="averaged", time={"end": 1, "step": dt}
    )
    s, p = run.simulation, run.particles
    rng = np.random.default_rng(3)
    p.tau[:], p.V[:] = rng.standard_normal(p.tau.shape), rng.standard_normal(p.V.shape)
    S, G = find_stencils(shape, s.grid, p.X, p.size, p.F).matrices()
    m = S.T @ p.mass
    S, G, m = S[:, m > 0], G[:, :, m > 0], m[m > 0]
    mean = 0.5 * (p.tau[0] + p.tau[1])
    shift = average(S, p.vol0, mean) - mean
    tau = np.array([[p.tau[0] + shift, p.tau[3]], [p.tau[3], p.tau[1] + shift]])
    a = -np.einsum("p,abp,bpn->na", p.vol0, tau, G) / m[:, None]
    V, X = p.V.T.copy(), p.X.T.copy()
    s.step()
    np.testing.assert_allclose(p.V.T, V + S @ a * dt, rtol=0, atol=ROOM)
    assert np.abs(p.X.T - X).max() > 0
    rate = p.L[0] + p.L[3]
    wanted = average(S, p.vol0, rate)
    grown = p.F[0] * p.F[3] - p.F[1] * p.F[2] - 1.0
    assert np.abs(wanted - rate).max() > 0.1
    np.testing.assert_allclose(grown / dt, wanted, rtol=0, atol=2e-5)


def test_uniform_compression_is_left_alone(block):
    """The average of a uniform field is that field."""
    keys = {"bodies__0__velocity": ["-0.3*x", "-0.3*y"]}
    start = {"bodies__0__region": {"kind": "box", "lower": [-4, -4], "upper": [4, 4]}}
    runs = [block(**keys, **start, **more) for more in ({}, AVERAGED)]
    inside = np.abs(runs[0].ordered("X")).max(axis=0) < 1.5
    for run in runs:
        run.steps(1)
    local, averaged = (run.ordered("tau")[:, inside] for run in runs)
    assert np.abs(local[0]).min() > 0
    np.testing.assert_allclose(averaged, local, rtol=1e-9)


@pytest.mark.parametrize("shape", ["ugimp", "lcpdi"])
def test_averaged_forces_do_the_work_of_the_averaged_strain(block, shape):
    """Σ Ω τ̄:∇V = Σ Ω τ:∇V̄, to round-off, in a body that is far from its start."""
    run = block(**TIGHT, **AVERAGED, method__shape=shape).steps(40)
    s, p = run.simulation, run.particles
    tau = p.tau.copy()
    run.steps(1)
    assert s.order.drift > 0  # not sorted at the start of the step
    averaging, rows = s.averaging, (0, 3, 1, 2)
    of_forces = (
        p.vol0 * sum(averaging.tau[i] * p.L[j] for i, j in zip((0, 1, 3, 3), rows, strict=True))
    ).sum()
    of_strain = (p.vol0 * sum(tau[i] * averaging.L[j] for i, j in zip((0, 1, 3, 3), rows, strict=True))).sum()
    local = (p.vol0 * sum(tau[i] * p.L[j] for i, j in zip((0, 1, 3, 3), rows, strict=True))).sum()
    assert of_forces == pytest.approx(of_strain, rel=1e-11)
    assert abs(local - of_forces) > 1e-4 * abs(of_forces)


def test_the_balance_of_energy_closes_as_the_step_shrinks(block):
    errors = [block(**TIGHT, **AVERAGED, time__courant=C).until(0.3).error for C in (0.2, 0.0125)]
    assert errors[1] < 0.25 * errors[0]


def test_a_quarter_between_symmetry_planes_is_the_whole(block):
    def run(lower, planes):
        return block(
            bodies__0__region={"kind": "box", "lower": [lower, lower], "upper": [3, 3]},
            bodies__0__velocity=["-0.8*x + 0.1*x*y*y", "0.5*y"],
            boundary=[
                {"name": a, "kind": "symmetry", "plane": {"axis": a, "at": 0, "side": "lower"}} for a in planes
            ],
            **TIGHT, **AVERAGED,
        ).steps(20)  # fmt: skip

    whole, quarter = run(-3, ""), run(0, "xy")
    assert quarter.energy == pytest.approx(0.25 * whole.energy, rel=1e-9)
    X = whole.ordered("X")
    mine = (X > 0).all(axis=0)
    pressure = [r.ordered("tau")[:2].mean(axis=0) for r in (whole, quarter)]
    np.testing.assert_allclose(pressure[1], pressure[0][mine], rtol=0, atol=1e-9 * np.abs(pressure[0]).max())


def test_particles_may_go_while_volumes_are_averaged(block):
    run = block(
        **AVERAGED, domain={"on_exit": "delete"},
        bodies__0__velocity=["50", "0"], bodies__0__region={"kind": "box", "lower": [3, -2], "upper": [7, 2]},
    )  # fmt: skip
    count = run.particles.count
    while run.simulation.state.extra["deleted_particles"] == 0:
        run.steps(1)
    run.steps(2)
    assert 0 < run.particles.count < count
