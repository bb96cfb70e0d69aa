"""Each contact law against its formula, and what scenes may say about it."""

import math

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.optimize import brentq

from mpmcli.contact.laws import LAWS
from mpmcli.contact.laws.impulse import APART, BROKEN, SLIDING, STICKING, law_impulse

N_HAT = np.array([0.0, 1.0])
T_HAT = np.array([-1.0, 0.0])
DT, AREA = 0.25, 3.0


def law_of(kind, **numbers):
    return LAWS[kind].model_validate({"kind": kind, **numbers}).parameters()


def settled(law, normal, shear, separation=-1.0, mass=1.0, bond=0.0, area=AREA, displacement_only=False):
    """Normal and tangential part of the settled impulse, and the state."""
    out = np.zeros(2)
    dp0 = normal * N_HAT + shear * T_HAT
    state = law_impulse(law, (0.0, 0.0), dp0, N_HAT, separation, area, mass, DT, displacement_only, bond, out)
    return out @ N_HAT, out @ T_HAT, state


@pytest.mark.parametrize("shear", [0.3, -0.3, 5.0, -5.0])
def test_frictionless(shear):
    normal, tangent, state = settled(law_of("frictionless"), -2.0, shear)
    assert (normal, tangent) == pytest.approx((-2.0, 0.0), abs=1e-15)
    assert state == SLIDING


@pytest.mark.parametrize(("shear", "expected"), [(0.5, 0.5), (0.6, 0.6), (0.7, 0.6), (-9.0, -0.6)])
def test_coulomb(shear, expected):
    normal, tangent, state = settled(law_of("coulomb", friction=0.3), -2.0, shear)
    assert normal == pytest.approx(-2.0, rel=1e-15)
    assert tangent == pytest.approx(expected, rel=1e-14)
    assert state == (SLIDING if abs(shear) > 0.6 else STICKING)


def test_static_friction_jumps_to_kinetic():
    law = law_of("coulomb", friction=0.3, static_friction=0.5)
    assert settled(law, -2.0, 0.999)[1:] == (pytest.approx(0.999), STICKING)
    assert settled(law, -2.0, 1.001)[1:] == (pytest.approx(0.6), SLIDING)


def test_coulomb_needs_no_area():
    law = law_of("coulomb", friction=0.3)
    assert settled(law, -2.0, 4.0, area=0.0) == settled(law, -2.0, 4.0)


def test_stick_holds_only_in_contact():
    law = law_of("stick")
    assert settled(law, -1e-3, 7.0) == (pytest.approx(-1e-3), pytest.approx(7.0), STICKING)
    assert settled(law, 1e-3, 7.0) == (0, 0, APART)
    assert settled(law, -1.0, 7.0, separation=0.0) == (0, 0, APART)


@pytest.mark.parametrize("normal", [-1.0, 1.0])
@pytest.mark.parametrize("separation", [-1.0, 1.0])
def test_perfect_and_none(normal, separation):
    found = settled(law_of("perfect"), normal, 2.0, separation=separation)
    assert found == (pytest.approx(normal), pytest.approx(2.0), STICKING)
    assert settled(law_of("none"), normal, 2.0, separation=separation) == (0, 0, APART)


def test_displacement_alone_may_pull():
    law = law_of("coulomb", friction=0.3)
    normal, tangent, state = settled(law, 1.0, 2.0, displacement_only=True)
    assert (normal, tangent) == pytest.approx((1.0, 0.0), abs=1e-15)
    assert state == SLIDING
    assert settled(law, 1.0, 2.0, separation=0.0, displacement_only=True)[2] == APART
    assert settled(law_of("stick"), 1.0, 2.0, displacement_only=True)[:2] == pytest.approx((1.0, 2.0))


def random_contacts(count):
    rng = np.random.default_rng(5)
    for _ in range(count):
        yield 10 ** rng.uniform(-3, 2), 10 ** rng.uniform(-3, 3), 10 ** rng.uniform(-3, 2)


@pytest.mark.parametrize(
    ("friction", "static", "speed", "viscosity"),
    [
        (0.1, 0.6, 0.5, 0.0),
        (0.1, 0.6, 1e-4, 0.3),
        (0.6, 0.1, 0.5, 0.01),
        (0.0, 0.0, 1.0, 2.0),
        (0.3, 0.3, 1.0, 1e6),
    ],
)
def test_velocity_friction_agrees_with_the_speed_it_leaves(friction, static, speed, viscosity):
    law = law_of(
        "velocity_friction",
        friction=friction,
        static_friction=static,
        characteristic_speed=speed,
        viscosity=viscosity,
    )

    def traction(N, v):
        return (friction + (static - friction) * math.exp(-v / speed)) * N + viscosity * v

    slid = 0
    for pressed, shear, mass in random_contacts(200):
        _, tangent, state = settled(law, -pressed, shear, mass=mass)
        N, stick = pressed / (AREA * DT), shear / (AREA * DT)

        def residual(S, N=N, stick=stick, mass=mass):
            return traction(N, (stick - S) * AREA * DT / mass) - S

        if traction(N, 0.0) >= stick:
            assert state == STICKING
            continue
        slid += 1
        S = tangent / (AREA * DT)
        slope = 1 + viscosity * AREA * DT / mass + abs(static - friction) * N / speed * AREA * DT / mass
        assert abs(residual(S)) <= 1e-10 * S + 1e-14 * stick * slope
        assert pytest.approx(brentq(residual, 0.0, stick, xtol=1e-300, rtol=1e-14), rel=1e-10) == S
    assert slid > 50


def test_velocity_friction_becomes_coulomb():
    """With a small characteristic speed the coefficient jumps from static to kinetic."""
    smooth = law_of("velocity_friction", friction=0.3, static_friction=0.5, characteristic_speed=1e-9)
    sharp = law_of("coulomb", friction=0.3, static_friction=0.5)
    for pressed, shear, mass in random_contacts(100):
        found, expected = (
            settled(smooth, -pressed, shear, mass=mass),
            settled(sharp, -pressed, shear, mass=mass),
        )
        assert found == pytest.approx(expected, rel=1e-6)


def test_viscous_film_at_low_speed():
    """Without normal dependence the slip decays as m dv/dt = −c A v, here by one implicit step."""
    law = law_of("velocity_friction", friction=0, viscosity=2.0)
    _, tangent, _ = settled(law, -1.0, 4.0, mass=5.0)
    left = (4.0 - tangent) / 5.0
    assert left == pytest.approx(4.0 / 5.0 / (1 + 2.0 * AREA * DT / 5.0), rel=1e-13)


BOND = {"normal_strength": 2.0, "shear_strength": 5.0, "friction": 0.4}


@pytest.mark.parametrize("angle", np.linspace(0, math.pi, 9))
@pytest.mark.parametrize("separation", [-1.0, 1.0])
def test_bond_breaks_on_an_ellipse_in_tension(angle, separation):
    law = law_of("adhesion_friction", **BOND)
    pull, shear = 2.0 * math.sin(angle) * AREA * DT, 5.0 * math.cos(angle) * AREA * DT
    normal, tangent, state = settled(law, 0.999 * pull, 0.999 * shear, separation=separation, bond=0.6)
    assert (normal, tangent) == pytest.approx((0.999 * pull, 0.999 * shear))
    assert state == STICKING
    pull += 1e-12
    found = settled(law, 1.001 * pull, 1.001 * shear, separation=separation, bond=0.6)
    assert found == (0, 0, BROKEN)


@pytest.mark.parametrize("separation", [-1.0, 1.0])
def test_bond_in_compression_has_the_strength_of_friction_too(separation):
    law = law_of("adhesion_friction", **BOND)
    limit = 5.0 * AREA * DT + 0.4 * 2.0
    assert settled(law, -2.0, 0.999 * limit, separation=separation, bond=1.0)[2] == STICKING
    normal, tangent, state = settled(law, -2.0, 1.001 * limit, separation=separation, bond=1.0)
    assert state == BROKEN
    expected = (-2.0, 0.8) if separation < 0 else (0.0, 0.0)
    assert (normal, tangent) == pytest.approx(expected)


@pytest.mark.parametrize("bond", [0.0, 0.5])
def test_broken_bond_is_friction(bond):
    law, friction = law_of("adhesion_friction", **BOND), law_of("coulomb", friction=0.4)
    for normal in (-1.0, 1.0):
        for shear in (0.1, 3.0):
            assert settled(law, normal, shear, bond=bond) == settled(friction, normal, shear)


def test_bond_without_area_breaks():
    law = law_of("adhesion_friction", **BOND)
    assert settled(law, 1e-9, 0.0, bond=1.0, area=0.0)[2] == BROKEN
    assert settled(law, 0.0, 0.0, bond=1.0, area=0.0)[2] == STICKING


@pytest.mark.parametrize(
    "numbers",
    [
        {"kind": "coulomb"},
        {"kind": "coulomb", "friction": -0.1},
        {"kind": "coulomb", "friction": 0.3, "static_friction": 0.2},
        {"kind": "stick", "stiffness": 0},
        {"kind": "perfect", "stiffness": 1},
        {"kind": "none", "friction": 1},
        {"kind": "adhesion_friction", "friction": 0.1, "normal_strength": 1},
        {"kind": "adhesion_friction", "friction": 0.1, "normal_strength": 1, "shear_strength": 0},
        {"kind": "velocity_friction", "friction": 0.1, "static_friction": 0.2},
        {"kind": "velocity_friction", "friction": 0.1, "characteristic_speed": 2},
        {"kind": "velocity_friction", "friction": 0.1, "viscosity": -1},
    ],
)
def test_refused(numbers):
    with pytest.raises(ValidationError):
        LAWS[numbers["kind"]].model_validate(numbers)


def test_every_law_is_registered():
    assert {kind for kind in LAWS if not LAWS[kind].is_interface} == {
        "adhesion_friction",
        "coulomb",
        "frictionless",
        "none",
        "perfect",
        "stick",
        "velocity_friction",
    }
    assert [kind for kind in LAWS if not (LAWS[kind].screened or LAWS[kind].is_interface)] == ["perfect"]
    assert [kind for kind in LAWS if LAWS[kind].skipped] == ["none"]
