"""Solving for the momentum of a contact: soft contact, slip speed, friction work, increments of FMPM."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mpmcli.contact.increments import finish_increment, start_increments, total_increment
from mpmcli.contact.laws import LAWS
from mpmcli.contact.laws.impulse import (
    APART,
    SLIDING,
    STICKING,
    contact_law,
    is_soft,
    law_impulse,
    law_impulse_at_end,
    length,
    sliding_traction,
    slip_work,
)
from mpmcli.contact.laws.stiffness import stumpff

AXES = (0.0, 0.0)
N_HAT = np.array([0.6, 0.8])
T_HAT = np.array([-0.8, 0.6])
DT, AREA, MASS = 0.25, 3.0, 1.7


def law_of(kind, **numbers):
    return LAWS[kind].model_validate({"kind": kind, **numbers}).parameters()


def soft(
    law, normal, shear, separation, force, mass=MASS, area=AREA, dt=DT, displacement_only=False, bond=0.0
):
    out = np.zeros(2)
    dp0 = normal * N_HAT + shear * T_HAT
    state = law_impulse_at_end(
        law, AXES, dp0, N_HAT, separation, force, area, mass, dt, displacement_only, bond, out
    )
    return out @ N_HAT, out @ T_HAT, state


def hard(law, normal, shear, separation):
    out = np.zeros(2)
    dp0 = normal * N_HAT + shear * T_HAT
    state = law_impulse(law, AXES, dp0, N_HAT, separation, AREA, MASS, DT, False, 0.0, out)
    return out @ N_HAT, out @ T_HAT, state


@pytest.mark.parametrize("size", [0.0, 5e-324, 1e-300, 1e-160, 1.0, 1e160, 1e300])
def test_length(size):
    assert length((0.0, 0.0, 0.0), size * np.array([2.0, -3.0, 6.0])) == pytest.approx(7 * size, rel=1e-15)


@pytest.mark.parametrize("u", [0.0, 1e-12, 1e-3, 0.5, 2.4674])
def test_stumpff(u):
    c2, c3, c4 = stumpff(u)
    if u < 0.1:
        expected = [1 / math.factorial(i) - u / math.factorial(i + 2) for i in (2, 3, 4)]
        assert (c2, c3, c4) == pytest.approx(expected, rel=1e-8)
    else:
        phi = math.sqrt(u)
        expected = [(1 - math.cos(phi)) / u, (1 - math.sin(phi) / phi) / u]
        assert (c2, c3) == pytest.approx(expected, rel=1e-14)
        assert c4 == pytest.approx((0.5 - expected[0]) / u, rel=1e-13)


@pytest.mark.parametrize("kind", ["frictionless", "coulomb", "stick"])
@pytest.mark.parametrize("normal", [-1.0, 1.0])
@pytest.mark.parametrize("separation", [-0.3, 0.05, 0.3])
def test_large_stiffness_is_hard_contact(kind, normal, separation):
    numbers = {"friction": 0.3} if kind == "coulomb" else {}
    end = separation + (normal - 0.5 * 0.7 * DT) * DT / MASS
    expected = hard(law_of(kind, **numbers), normal, 2.0, end)
    for stiffness in (1e3, 1e30, None):
        law = law_of(kind, **numbers, stiffness=stiffness)
        assert is_soft(law) == (stiffness is not None)
        assert soft(law, normal, 2.0, separation, 0.7) == expected


def test_rigid_up_to_a_quarter_period():
    """φ = √(D_c A_c Δt²/m_red) = π/2 is the border."""
    border = (math.pi / 2) ** 2 * MASS / (AREA * DT * DT)
    rigid = soft(law_of("stick"), -1.0, 2.0, -0.3, 0.7)
    assert soft(law_of("stick", stiffness=1.0001 * border), -1.0, 2.0, -0.3, 0.7) == rigid
    assert soft(law_of("stick", stiffness=0.9999 * border), -1.0, 2.0, -0.3, 0.7) != rigid


@pytest.mark.parametrize("stiffness", [1e-6, 0.1, 1.0, 20.0])
@pytest.mark.parametrize("separation", [-0.5, -0.05])
@pytest.mark.parametrize("force", [-1.0, 0.0, 2.0])
def test_spring_moves_as_its_equation_of_motion(stiffness, separation, force):
    """The effective force takes the sides where the oscillator m δ″ = f − D_c A_c δ goes (Nairn 2023, Eq. 5.18)."""
    start, normal = -0.8, -0.8 + force * DT  # momentum at the start and after the update
    impulse, tangent, state = soft(law_of("stick", stiffness=stiffness), normal, 2.0, separation, force)
    motion = solve_ivp(
        lambda t, y: [y[1], (force - stiffness * AREA * y[0]) / MASS],
        (0, DT),
        [separation, start / MASS],
        rtol=1e-12,
        atol=1e-14,
    )
    end = motion.y[0, -1]
    assert end < 0
    predicted = separation + (start * DT + 0.5 * (force - impulse / DT) * DT**2) / MASS
    assert predicted == pytest.approx(end, abs=1e-10)
    assert tangent == pytest.approx(2.0)
    assert state == STICKING
    phi = math.sqrt(stiffness * AREA * DT * DT / MASS)
    m = MASS / DT
    printed = (
        separation * math.cos(phi)
        + normal / m * math.sin(phi) / phi
        + force * DT / m * ((1 - math.cos(phi)) / phi**2 - math.sin(phi) / phi)
    )  # Eq. 5.149
    assert printed == pytest.approx(end, abs=1e-9)
    assert impulse == pytest.approx(
        2 * (m * (separation - printed) + normal) - force * DT, abs=1e-9
    )  # Eq. 5.150


def test_soft_collision_lasts_half_a_period():
    """A mass thrown on a soft contact comes back after π/κ, as deep as v/κ and as fast as it came."""
    law = law_of("frictionless", stiffness=2.0)
    kappa = math.sqrt(2.0 * AREA / MASS)
    dt = 0.01 / kappa
    gap, v, depth, t = -1e-12, -1.0, 0.0, 0.0
    while gap < 0:
        impulse, _, _ = soft(law, MASS * v, 0.0, gap, 0.0, dt=dt)
        gap += v * dt - 0.5 * impulse * dt / MASS
        v -= impulse / MASS
        depth, t = min(depth, gap), t + dt
    assert t == pytest.approx(math.pi / kappa, abs=1.5 * dt)
    assert -depth == pytest.approx(1 / kappa, rel=0.01)
    assert v == pytest.approx(1.0, rel=0.01)


def test_soft_contact_pulls_only_if_displacement_decides():
    """Sides that were apart most of the step: the spring would pull (Nairn 2023, 5.7, step 5)."""
    law = law_of("stick", stiffness=1.0)
    assert soft(law, -2.2, 0.0, 0.3, 0.0) == (0, 0, APART)
    normal, _, state = soft(law, -2.2, 0.0, 0.3, 0.0, displacement_only=True)
    assert normal > 0
    assert state == STICKING


def test_overlapping_sides_push_even_as_they_part():
    normal, _, _ = soft(law_of("stick", stiffness=1.0), 3.0, 0.0, -0.5, 0.0)
    assert normal < 0


def test_soft_friction_is_that_of_the_spring():
    law = law_of("coulomb", friction=0.3, stiffness=1.0)
    normal, tangent, state = soft(law, -0.2, 5.0, -0.5, 0.0)
    assert state == SLIDING
    assert abs(normal) > 0.2  # the overlap pushes harder than the approach
    assert tangent == pytest.approx(-0.3 * normal, rel=1e-14)


def test_soft_contact_without_area_does_nothing():
    assert soft(law_of("stick", stiffness=1.0), -1.0, 2.0, -0.5, 0.3, area=0.0) == (0, 0, APART)


def test_friction_work_is_the_energy_that_sliding_takes():
    rng = np.random.default_rng(2)
    m = np.array([1.3, 0.4])
    mass = m.prod() / m.sum()
    for _ in range(50):
        v = rng.normal(size=(2, 2))
        dp0 = mass * (v[1] - v[0])
        if dp0 @ N_HAT >= 0:
            continue
        dp = np.zeros(2)
        law_impulse(law_of("coulomb", friction=0.3), AXES, dp0, N_HAT, -1.0, AREA, mass, DT, False, 0.0, dp)
        after = v + np.stack([dp / m[0], -dp / m[1]])
        work = slip_work(AXES, N_HAT, dp, v[1] - v[0], after[1] - after[0])
        before_t, after_t = v @ T_HAT, after @ T_HAT
        lost = 0.5 * (m * (before_t**2 - after_t**2)).sum()
        assert work == pytest.approx(lost, abs=1e-14)
        assert work >= 0


def test_steady_sliding_works_as_force_times_path():
    """Sides driven at a constant speed: μN A v Δt."""
    impulse = -2.0 * N_HAT + 0.6 * T_HAT
    slip = 1.5 * T_HAT - 0.1 * N_HAT
    assert slip_work(AXES, N_HAT, impulse, slip, slip) == pytest.approx(0.6 * 1.5)
    assert slip_work(AXES, N_HAT, -2.0 * N_HAT, slip, slip) == pytest.approx(0, abs=1e-16)


# increments


@contact_law(area=True)
class Quadratic(NamedTuple):
    """A traction c N², which is neither linear nor homogeneous."""

    c: float


@sliding_traction.register(Quadratic)
def _(law, N, stick, speed):
    return law.c * N * N


@contact_law()
class Linear(NamedTuple):
    """A traction μ N, never held back by sticking in these tests."""

    mu: float


@sliding_traction.register(Linear)
def _(law, N, stick, speed):
    return law.mu * N


def increments(law, first, others, evolving, separation=-1.0):
    """Total impulse, list of effective impulses after the first, and the last prior and net."""
    dp, prior, net, total, effective = (np.zeros(2) for _ in range(5))
    law_impulse(law, AXES, first, N_HAT, separation, AREA, MASS, DT, False, 0.0, dp)
    start_increments(AXES, evolving, first, dp, prior, net)
    applied, added = dp.copy(), []
    for own in others:
        total_increment(AXES, prior, own, total)
        law_impulse(law, AXES, total, N_HAT, separation, AREA, MASS, DT, False, 0.0, dp)
        finish_increment(AXES, evolving, own, total, dp, prior, net, effective)
        applied += effective
        added.append(effective.copy())
    return applied, added, prior, net


FIRST = -2.0 * N_HAT + 9.0 * T_HAT
OTHERS = [-0.7 * N_HAT + 0.3 * T_HAT, -0.2 * N_HAT - 0.1 * T_HAT, -0.05 * N_HAT + 0.2 * T_HAT]


@pytest.mark.parametrize("evolving", [False, True])
@pytest.mark.parametrize("separation", [-1.0, 1.0])
def test_perfect_contact_is_one_field(evolving, separation):
    """Every increment is taken to the centre of mass, to the last digit."""
    rng = np.random.default_rng(6)
    others = list(rng.normal(size=(15, 2)) * 10.0 ** rng.uniform(-12, 0, (15, 1)))
    _, added, prior, net = increments(law_of("perfect"), FIRST, others, evolving, separation)
    np.testing.assert_array_equal(added, others)
    np.testing.assert_allclose(net, FIRST + sum(others), rtol=1e-14)
    np.testing.assert_array_equal(prior, np.zeros(2) if evolving else net)


@pytest.mark.parametrize("evolving", [False, True])
def test_net_is_the_sum_of_what_was_applied(evolving):
    applied, _, _, net = increments(law_of("coulomb", friction=0.4), FIRST, OTHERS, evolving)
    np.testing.assert_allclose(net, applied, rtol=1e-14)


def test_net_equals_evolving_for_a_linear_law():
    applied, added, _, _ = increments(Linear(0.4), FIRST, OTHERS, False)
    evolving, evolving_added, _, _ = increments(Linear(0.4), FIRST, OTHERS, True)
    np.testing.assert_allclose(applied, evolving, rtol=1e-13)
    np.testing.assert_allclose(added, evolving_added, rtol=1e-12, atol=1e-15)


def test_net_and_evolving_for_a_quadratic_law():
    """Nairn 2026, Eqs. 21 and 22: g(N₂) against g(N₁) + g(N₂ − N₁)."""
    N1, N2 = 2.0 / (AREA * DT), 2.7 / (AREA * DT)

    def g(N):
        return 0.1 * N * N * AREA * DT

    net = increments(Quadratic(0.1), FIRST, OTHERS[:1], False)[0]
    evolving = increments(Quadratic(0.1), FIRST, OTHERS[:1], True)[0]
    assert net @ T_HAT == pytest.approx(g(N2), rel=1e-13)
    assert evolving @ T_HAT == pytest.approx(g(N1) + g(N2 - N1), rel=1e-13)
    assert net @ N_HAT == pytest.approx(-2.7, rel=1e-14)
    assert evolving @ N_HAT == pytest.approx(-2.7, rel=1e-14)


def test_lost_contact():
    """An increment that parts the sides: "Net" takes back what contact gave, "Evolving" leaves it."""
    apart = [3.0 * N_HAT]
    law = law_of("coulomb", friction=0.4)
    applied, added, _, net = increments(law, FIRST, apart, False)
    np.testing.assert_allclose(applied, 0, atol=1e-14)
    assert not net.any()
    first = -2.0 * N_HAT + 0.8 * T_HAT
    np.testing.assert_allclose(added[0], -first, atol=1e-14)
    applied, added, prior, _ = increments(law, FIRST, apart, True)
    np.testing.assert_allclose(applied, first, rtol=1e-14)
    assert not added[0].any()
    np.testing.assert_allclose(prior, 3.0 * N_HAT + 8.2 * T_HAT, rtol=1e-13)


def test_sticking_increment_is_exact_after_slip():
    """A contact that slid and then sticks moves on by the new momentum less what slid before."""
    own = [-100.0 * N_HAT]
    applied, _, _, _ = increments(law_of("coulomb", friction=0.4), FIRST, own, False)
    np.testing.assert_allclose(applied, FIRST + own[0], rtol=1e-14)
