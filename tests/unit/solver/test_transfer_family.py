"""Periodic, blended, dynamic and affine transfers (Nairn 2026, sections 3.3 and 3.4)."""

import numpy as np
import pytest

FMPM4 = {"kind": "fmpm", "order": 4}


def same_state(a, b):
    return all(np.array_equal(a.ordered(name), b.ordered(name)) for name in ("X", "V", "tau"))


@pytest.mark.parametrize("kind", ["fmpm", "xpic"])
def test_a_period_of_one_step_changes_nothing(kind, block):
    plain = block(method__transfer={"kind": kind, "order": 3}).steps(8)
    periodic = block(method__transfer={"kind": kind, "order": 3, "every_steps": 1}).steps(8)
    assert same_state(plain, periodic)


def test_a_period_longer_than_the_run_is_flip(block):
    flip = block(method__transfer={"kind": "flip"}).steps(8)
    periodic = block(method__transfer=FMPM4 | {"every_steps": 100}).steps(8)
    assert same_state(flip, periodic)


def test_a_period_by_courant_number_counts_the_steps_in_between(block):
    by_courant = block(method__transfer=FMPM4 | {"every_courant": 0.8}).steps(12)
    by_steps = block(method__transfer=FMPM4 | {"every_steps": 4}).steps(12)
    assert same_state(by_courant, by_steps)
    assert by_steps.simulation.state.extra["mean_order"] == pytest.approx((3 * 4 + 9 * 1) / 12)


def test_a_fraction_of_one_blends_nothing_and_of_zero_leaves_the_lower_order(block):
    whole = block(method__transfer=FMPM4 | {"blend": {"order": 2, "fraction": 1}}).steps(6)
    assert same_state(whole, block(method__transfer=FMPM4).steps(6))
    none = block(method__transfer=FMPM4 | {"blend": {"order": 2, "fraction": 0}}).steps(6)
    assert same_state(none, block(method__transfer={"kind": "fmpm", "order": 2}).steps(6))
    pic = block(method__transfer=FMPM4 | {"blend": {"order": 1, "fraction": 0}}).steps(6)
    assert same_state(pic, block(method__transfer={"kind": "fmpm", "order": 1}).steps(6))


@pytest.mark.parametrize(
    ("energy_lost", "fraction"),
    [(0.404, 0.0), (0.339, 0.2), (0.267, 0.4), (0.188, 0.6), (0.099, 0.8), (0.051, 0.9), (0.0, 1.0)],
)
def test_what_blending_with_order_one_costs_the_vibrating_bar(energy_lost, fraction, bar):
    """Fig. 12B of Nairn (2026): kinetic and strain energy lost in five periods at C = 0.539."""
    run = bar(
        method__transfer=FMPM4 | {"blend": {"order": 1, "fraction": fraction}},
        grid__upper=[50],
        bodies__0__region={"kind": "box", "lower": [0], "upper": [40]},
        bodies__0__velocity=["0.16*sin(pi*x/80)"],
        time={"end": 400.0, "courant": 0.539 if fraction < 1 else 0.53},
    )
    start = run.kinetic_energy
    while run.simulation.time < 400.0:
        run.simulation.step()
    stored = run.look()
    p = run.particles
    strain = float(np.sum(p.vol0 * stored.state.strain_energy_density()))
    assert 1.0 - (run.kinetic_energy + strain) / start == pytest.approx(
        energy_lost, abs=0.005 if energy_lost else 0.001
    )


@pytest.mark.parametrize("metric", ["means", "changes"])
def test_a_dynamic_order_lies_between_two_and_the_largest(metric, block):
    def run(tolerance):
        dynamic = {"metric": metric, "tolerance": tolerance}
        return block(method__transfer={"kind": "fmpm", "order": 6, "dynamic": dynamic}).steps(6)

    assert same_state(run(1e3), block(method__transfer={"kind": "fmpm", "order": 2}).steps(6))
    assert same_state(run(1e-12), block(method__transfer={"kind": "fmpm", "order": 6}).steps(6))
    between = run(0.03).simulation.state.extra["mean_order"]
    assert 2.0 <= between < 6.0
    assert run(1e3).simulation.state.extra["mean_order"] == 2.0
    assert run(1e-12).simulation.state.extra["mean_order"] == 6.0


@pytest.mark.parametrize("update", ["usf", "usl", "usl+", "usavg", "usavg+"])
@pytest.mark.parametrize(
    "transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 3}, {"kind": "xpic", "order": 3}]
)
def test_affine_transfers_keep_momentum(update, transfer, block):
    run = block(method__update=update, method__transfer=transfer | {"velocity_gradient": True})
    before, mass = run.momentum, run.particles.mass.sum()
    run.steps(12)
    np.testing.assert_allclose(run.momentum, before, rtol=0, atol=1e-12 * mass)
    assert np.isfinite(run.particles.tau).all()


def test_affine_transfers_keep_the_angular_momentum_of_the_initial_field(block):
    """With the gradient order 1 keeps a linear velocity field, which PIC smears out."""

    def loss(**transfer):
        run = block(method__transfer={"kind": "fmpm", "order": 1} | transfer)
        before = run.angular_momentum
        run.steps(10)
        return abs(run.angular_momentum / before - 1.0)

    assert loss(velocity_gradient=True) < 0.1 * loss()


def spinning_disk(block, method):
    return block(
        method=method,
        grid={"lower": [-12, -12], "upper": [12, 12], "cell": 1},
        materials__soft={"kind": "neo_hookean", "density": 1.5e-3, "E": 1000.0, "nu": 0.33},
        bodies__0={
            "name": "disk",
            "material": "soft",
            "region": {"kind": "disk", "center": [0, 0], "radius": 10},
            "velocity": ["-1.99*y", "1.99*x"],
        },
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "transfer", [{"kind": "flip"}, *({"kind": "fmpm", "order": order} for order in (1, 2, 4))]
)
def test_a_spinning_disk_keeps_its_energy_with_the_gradient(transfer, block):
    """One turn at C = 0.2: kinetic energy 0.997 and angular momentum 1.0012 of the start."""
    run = spinning_disk(block, {"shape": "lcpdi", "transfer": transfer | {"velocity_gradient": True}})
    kinetic, spin = run.kinetic_energy, run.angular_momentum
    while run.simulation.time < 3.157:
        run.simulation.step()
    assert run.kinetic_energy / kinetic == pytest.approx(0.997, abs=0.002)
    assert run.angular_momentum / spin == pytest.approx(1.0012, abs=0.001)


@pytest.mark.slow
@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 4}])
def test_a_spinning_disk_keeps_everything_with_linear_increments(transfer, block):
    """One turn: the radius without the 0.25 % of exponential increments, energy and angular momentum to 2e-4."""
    method = {"shape": "lcpdi", "transfer": transfer | {"velocity_gradient": True, "alpha": 1}}
    run = spinning_disk(block, method | {"deformation_increment": "linear"})
    p = run.simulation.particles
    kinetic, spin, square = run.kinetic_energy, run.angular_momentum, (p.mass * np.square(p.X)).sum()
    while run.simulation.time < 3.157:
        run.simulation.step()
    assert run.kinetic_energy / kinetic == pytest.approx(1.0, abs=3e-4)
    assert run.angular_momentum / spin == pytest.approx(1.0, abs=1e-4)
    assert (p.mass * np.square(p.X)).sum() / square == pytest.approx(1.0, abs=4e-4)
