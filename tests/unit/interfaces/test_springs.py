"""Springs of one direction: within the step against their equation of motion, at its end by the residual."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter
from scipy.integrate import quad, solve_ivp

from mpmcli.contact.laws.impulse import HARD
from mpmcli.interfaces.morse_interface import Mirrored, Morse
from mpmcli.interfaces.shapes import AnyShape
from mpmcli.interfaces.shapes.base import elastic_end, envelope, failure
from mpmcli.interfaces.softening import Softening, has_failed, lost, lost_share, worn
from mpmcli.interfaces.springs import (
    Elastic,
    Rigid,
    oscillate,
    oscillate_nonlinear,
    pull,
    rate,
    resist,
    settle,
    stored,
)
from mpmcli.interfaces.two_sided import OneSided, TwoSided

pytestmark = pytest.mark.usefixtures("python_and_compiled")
SHAPES = [
    {"shape": "triangular"},
    {"shape": "trilinear", "kink_opening": 0.4, "kink_strength": 0.3},
    {"shape": "trilinear", "peak": 0.1, "kink_opening": 0.9, "kink_strength": 1.0},
    {"shape": "cubic"},
    {"shape": "exponential", "alpha": 3},
    {"shape": "exponential", "alpha": 50, "peak": 0.1},
]
SIGMA, DELTA = 7.0, 0.03


def softening(keys):
    return Softening(
        TypeAdapter(AnyShape).validate_python(keys | {"strength": SIGMA, "opening": DELTA}).parameters()
    )


SOFT = [softening(keys) for keys in SHAPES]
MORSE = Morse(8 * SIGMA**2 / 900, 900 / (4 * SIGMA))
ELASTIC = [Elastic(0.0), Elastic(400.0), TwoSided(300.0, 900.0), TwoSided(0.0, 900.0), OneSided(300.0), MORSE]
names = {"ids": lambda spring: type(spring).__name__}


def motion(spring, opening, free, pushed, compliance):
    """c times the mean traction of a spring that moves by δ″ + c T(δ) = w within the step, found numerically.

    It is that whose constant force leaves the same opening: 2 (δ(0) + free − δ(1)) − w.
    """
    cross = lambda t, y: y[0]  # noqa: E731
    found = solve_ivp(
        lambda t, y: (y[1], pushed - compliance * pull(spring, y[0], 0.0)),
        (0, 1),
        (opening, free - pushed),
        rtol=1e-11,
        atol=1e-13,
        events=cross,
        max_step=0.01,
    )
    return 2 * (opening + free - found.y[0, -1]) - pushed, len(found.t_events[0])


lengths = st.floats(-1, 1).filter(lambda x: x == 0 or abs(x) > 1e-3)


@given(opening=lengths, free=lengths, pushed=lengths, phi=st.floats(1e-3, 1.57))
def test_elastic_spring_follows_its_motion(opening, free, pushed, phi):
    stiffness, compliance = 400.0, phi**2 / 400.0
    found = oscillate(Elastic(stiffness), opening, free, pushed, compliance, 0.0) * compliance
    expected = motion(Elastic(stiffness), opening, free, pushed, compliance)[0]
    assert found == pytest.approx(expected, abs=1e-9)


@given(
    opening=lengths, free=lengths, pushed=lengths, tension=st.floats(0, 1.5), compression=st.floats(0, 1.5)
)
def test_bilinear_spring_follows_its_motion(opening, free, pushed, tension, compression):
    """All branches of Nairn (2023), 5.5: open, closed, closing and opening; but not to and fro in one step."""
    compliance = 0.01
    spring = TwoSided(tension**2 / compliance, compression**2 / compliance)
    found = oscillate(spring, opening, free, pushed, compliance, 0.0) * compliance
    expected, crossings = motion(spring, opening, free, pushed, compliance)
    if crossings <= 1 and opening != 0.0:
        assert found == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("pushed", [-0.3, 0.0, 0.3])
@pytest.mark.parametrize("stiffness", [(0.0, 80.0), (80.0, 0.0), (1e-9, 150.0), (150.0, 40.0), (60.0, 60.0)])
def test_bilinear_spring_that_closes_or_opens(stiffness, pushed, sign):
    opening, free, compliance = 0.2 * sign, -0.6 * sign + pushed, 0.01
    spring = TwoSided(*stiffness)
    expected, crossings = motion(spring, opening, free, pushed, compliance)
    assert crossings == 1
    found = oscillate(spring, opening, free, pushed, compliance, 0.0) * compliance
    assert found == pytest.approx(expected, rel=1e-7)
    if stiffness[0] == stiffness[1]:
        assert found == pytest.approx(
            compliance * oscillate(Elastic(stiffness[0]), opening, free, pushed, compliance, 0.0), rel=1e-12
        )


def test_spring_that_closes_on_a_stiff_side_ends_closed():
    """Eq. 5.142: the impulse takes the opening to zero, when it closes does not matter."""
    for compression in (HARD / 0.01 * 1.01, 1e9):
        found = oscillate(TwoSided(50.0, compression), 0.2, -0.5, -0.1, 0.01, 0.0) * 0.01
        assert found == pytest.approx(2 * (0.2 - 0.5) + 0.1, rel=1e-14)
    assert oscillate(OneSided(50.0), 0.2, -0.5, -0.1, 0.01, 0.0) * 0.01 == pytest.approx(found, rel=1e-14)
    # closed and pressed: it sticks; open: as without the other side
    assert oscillate(OneSided(50.0), -1e-4, -0.5, 0.0, 0.01, 0.0) * 0.01 == pytest.approx(-0.5)
    assert oscillate(OneSided(50.0), 0.2, 0.1, 0.0, 0.01, 0.0) == pytest.approx(
        oscillate(Elastic(50.0), 0.2, 0.1, 0.0, 0.01, 0.0), rel=1e-14
    )


@pytest.mark.parametrize("spring", [Elastic(1e5), TwoSided(1e5, 1e5)], **names)
def test_too_stiff_for_the_step_sticks(spring):
    assert oscillate(spring, 0.3, 0.2, 5.0, 1.0, 0.0) == pytest.approx(0.2)


@pytest.mark.parametrize("spring", [*SOFT, MORSE, Elastic(400.0)], **names)
def test_first_order_form_follows_slow_motion(spring):
    """Eqs. 5.61 and 5.62: the error falls with φ² or faster."""
    for opening, most in ((0.3 * DELTA, 0.0), (0.5 * DELTA, 0.8 * DELTA)):
        errors = []
        for compliance in (2e-5, 2e-6):
            size = compliance * SIGMA
            free, pushed = 0.7 * size, -0.4 * size
            found = oscillate_nonlinear(spring, opening, free, pushed, compliance, most)
            mean = quad(
                lambda t: 2 * (1 - t) * pull(spring, opening + (free - pushed) * t, most),  # noqa: B023
                0,
                1,
            )[0]
            errors.append(abs(found - mean) / SIGMA)
        assert errors[0] < 1e-2
        assert errors[1] < max(0.15 * errors[0], 1e-12)


def test_first_order_form_sticks_or_lets_go():
    cubic = SOFT[3]
    soft = 2 * HARD / abs(rate(cubic, 0.6 * DELTA, 0.0))
    assert oscillate(cubic, 0.6 * DELTA, 1e-5, 0.0, soft, 0.0) == 0.0
    assert oscillate(cubic, 0.6 * DELTA, 1e-5, 0.0, 10 * soft, 0.99 * DELTA) != 0.0
    assert oscillate(SOFT[0], 0.01 * DELTA, 1e-5, 0.0, 1.0, 0.0) == pytest.approx(1e-5)


def test_morse_numbers():
    """Initial stiffness D, peak N at ln 2/a, energy."""
    assert rate(MORSE, 0.0, 0.0) == pytest.approx(900, rel=1e-14)
    peak = math.log(2) / MORSE.steepness
    assert pull(MORSE, peak, 0.0) == pytest.approx(SIGMA, rel=1e-14)
    assert rate(MORSE, peak, 0.0) == pytest.approx(0, abs=1e-11)
    for opening in (-0.02, 0.01, 0.2):
        work = quad(lambda x: pull(MORSE, x, 0.0), 0, opening, epsabs=1e-15)[0]
        assert stored(MORSE, opening, 0.0) == pytest.approx(work, rel=1e-9)
        assert pull(Mirrored(MORSE), -abs(opening), 0.0) == -pull(MORSE, abs(opening), 0.0)


@pytest.mark.parametrize("spring", [s for s in ELASTIC if not isinstance(s, OneSided)], **names)
@pytest.mark.parametrize("opening", [-0.03, 0.0, 1e-9, 0.02])
def test_stored_energy_is_the_work(spring, opening):
    work = quad(lambda x: pull(spring, x, 0.0), 0, opening, epsabs=1e-16)[0]
    assert stored(spring, opening, 0.0) == pytest.approx(work, rel=1e-9, abs=1e-18)


# ---------------------------------------------------------------------- the end of the step


def residual(spring, opening, target, compliance, most):
    found = opening + compliance * pull(spring, opening, most)
    return abs(found - target) / max(abs(target), abs(opening), 1e-300)


powers = st.floats(-8, 8)


@pytest.mark.parametrize("spring", [*SOFT, *ELASTIC, Mirrored(MORSE)], **names)
@given(start=st.floats(-1, 3), target=st.floats(-1, 3), power=powers, most=st.floats(0, 1.2))
def test_end_of_step(spring, start, target, power, most):
    """The residual vanishes, the traction points back, the opening shrinks, and the impulse does not overshoot."""
    target, compliance = target * DELTA, 10.0**power * DELTA / SIGMA
    most = max(most, abs(start)) * DELTA if isinstance(spring, Softening) else 0.0
    end = settle(spring, start * DELTA, target, compliance, most)
    traction = resist(spring, start * DELTA, target, compliance, most)
    assert end * target >= 0
    assert abs(end) <= abs(target) * (1 + 1e-15)
    assert traction * target >= 0
    # c T is what the spring takes from the opening: never more than all of it, so that nothing is sped up beyond rest
    assert compliance * abs(traction) <= abs(target) * (1 + 1e-9) + 1e-300
    if isinstance(spring, OneSided) and target < 0:
        assert end == 0
        assert compliance * traction == pytest.approx(target, rel=1e-14)
    else:
        slope = compliance * max(abs(rate(spring, x * end, most)) for x in (1 - 1e-9, 1, 1 + 1e-9))
        rest = abs(end + compliance * traction - target)
        assert rest <= 1e-14 * (1 + slope) * max(abs(target), abs(end), 1e-300)
        assert isinstance(spring, Softening) or traction == pull(spring, end, most)


@pytest.mark.parametrize("spring", [*SOFT, *ELASTIC], **names)
@given(power=powers, most=st.floats(0, 1.2))
def test_end_of_step_grows_with_the_target(spring, power, most):
    compliance, most = 10.0**power * DELTA / SIGMA, most * DELTA
    most = most if isinstance(spring, Softening) else 0.0
    targets = np.concatenate([-(10.0 ** np.linspace(2, -6, 60)), [0], 10.0 ** np.linspace(-6, 6, 90)]) * DELTA
    ends = np.array([settle(spring, 0.0, x, compliance, most) for x in targets])
    assert np.all(np.diff(ends) >= -1e-14 * np.abs(ends[1:]))


@pytest.mark.parametrize("spring", SOFT, **names)
@given(power=powers, start=st.floats(-1.2, 1.2), most=st.floats(0, 1.1), target=st.floats(0.01, 30))
def test_damage_of_a_step_is_that_of_its_start(spring, power, start, most, target):
    """Softening follows the openings that particles measure; light nodes overshoot within a step."""
    compliance, opening, target = 10.0**power * DELTA / SIGMA, start * DELTA, target * DELTA
    kept = max(most, abs(start), elastic_end(spring.shape) / DELTA, 1e-9) * DELTA
    stiffness = envelope(spring.shape, kept) / kept
    end = settle(spring, opening, target, compliance, most * DELTA)
    found = resist(spring, opening, target, compliance, most * DELTA)
    assert found == pytest.approx(stiffness * end, rel=1e-6, abs=1e-12 * SIGMA)
    assert end + compliance * found == pytest.approx(target, rel=1e-14)


@pytest.mark.parametrize("power", [1.0, 2.0, 6.0])
def test_morse_snaps_where_it_must_and_not_before(power):
    """Slowly opened and closed again: it lets go late and comes back late, along the two stable branches."""
    compliance, count = 10.0**power / 900, 150
    scale = 1 / MORSE.steepness
    targets = np.linspace(0, 12 * (1 + 900 * compliance / 4), count) * scale
    opened, ends = 0.0, []
    for target in (*targets, *targets[::-1]):
        opened = settle(MORSE, opened, target, compliance, 0.0)
        assert residual(MORSE, opened, target, compliance, 0.0) < 1e-12
        ends.append(opened)
    up, down = np.array(ends[:count]), np.array(ends[count:])[::-1]
    assert np.all(np.diff(up) >= -1e-12 * scale)
    assert np.all(up <= down + 1e-12 * scale)
    if power > 1.5:
        assert np.any(up < down - 0.5 * scale)


@pytest.mark.parametrize("spring", [*SOFT, *ELASTIC], **names)
def test_extremes(spring):
    for compliance in (0.0, 1e-300, 1e-20, 1e12, 1e150):
        for target in (-1e10, -1e-12, 0.0, 1e-200, 1.0, 1e10):
            for most in (0.0, 1e-9, 1e9):
                end = settle(spring, 0.5 * target, target, compliance, most)
                assert math.isfinite(end)
                assert math.isfinite(resist(spring, 0.5 * target, target, compliance, most))
                assert math.isfinite(oscillate(spring, 0.5 * target, 0.5 * target, 0.1, compliance, most))


@pytest.mark.parametrize("stiffness", [0.0, 1e-12, 1e12])
def test_stiff_springs_end_at_rest_and_soft_ones_do_nothing(stiffness):
    end = settle(Elastic(stiffness), 0.0, 0.1, 1.0, 0.0)
    assert end == pytest.approx(0.1 / (1 + stiffness), rel=1e-15)
    assert settle(Rigid(), 0.0, 0.1, 1.0, 0.0) == 0.0


# ---------------------------------------------------------------------- memory


@pytest.mark.parametrize("spring", SOFT, **names)
@given(path=st.lists(st.floats(0, 1.1), min_size=2, max_size=12))
def test_work_is_stored_and_spent(spring, path):
    """Along any path of openings the work of the traction is what is stored and what is spent."""
    at, most, work = 0.0, 0.0, 0.0
    for opening in np.array(path) * DELTA:
        pieces = sorted(
            {at, opening, *(x for x in (most, *spring.shape[1:]) if min(at, opening) < x < max(at, opening))}
        )
        for a, b in itertools.pairwise(pieces):
            piece = quad(lambda x: pull(spring, x, most), a, b, epsabs=1e-15)[0]  # noqa: B023
            work += piece if opening > at else -piece
        at, most = opening, max(most, opening)
        assert work == pytest.approx(stored(spring, at, most) + lost(spring, most), rel=1e-8, abs=1e-13)


@pytest.mark.parametrize("spring", SOFT, **names)
def test_unloading_goes_through_the_origin(spring):
    most = 0.6 * DELTA
    top = pull(spring, most, most)
    for share in (0.0, 0.3, 1.0):
        assert pull(spring, share * most, most) == pytest.approx(share * top, rel=1e-14)
        assert pull(spring, -share * most, most) == pytest.approx(-share * top, rel=1e-14)
    assert pull(spring, 0.7 * DELTA, most) == envelope(spring.shape, 0.7 * DELTA)


@pytest.mark.parametrize("spring", SOFT, **names)
def test_damage_grows_from_0_to_1(spring):
    x = np.linspace(0, 1.2, 301) * DELTA
    damage = np.array([worn(spring, most) for most in x])
    assert damage[0] == 0
    assert np.all(np.diff(damage) >= 0)
    assert np.all(damage[x >= DELTA] == 1)
    assert np.all(damage[(x > 0) & (x <= elastic_end(spring.shape))] == 0)
    shares = np.array([lost_share(spring, most) for most in x])
    assert np.all(np.diff(shares) >= -1e-15)
    assert shares[-1] == pytest.approx(1, rel=1e-14)
    assert has_failed(spring, failure(spring.shape))
    assert not has_failed(spring, failure(spring.shape) * (1 - 1e-12))


def test_elastic_modes_have_no_memory():
    assert (lost(Elastic(3.0), 9.0), lost_share(Elastic(3.0), 9.0), worn(Elastic(3.0), 9.0)) == (0, 0, 0)
    assert not has_failed(Elastic(3.0), 1e300)
