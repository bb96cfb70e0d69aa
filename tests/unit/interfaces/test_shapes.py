"""Shapes of cohesive laws: work, what is spent, the third number from two."""

import itertools

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError
from scipy.integrate import quad

from mpmcli.interfaces.shapes import AnyShape
from mpmcli.interfaces.shapes.base import elastic_end, envelope, envelope_slope, failure, secant, spent

SHAPE = TypeAdapter(AnyShape)
SHAPES = [
    {"shape": "triangular"},
    {"shape": "triangular", "peak": 0.01},
    {"shape": "triangular", "peak": 0.95},
    {"shape": "trilinear", "kink_opening": 0.4, "kink_strength": 0.3},
    {"shape": "trilinear", "peak": 0.1, "kink_opening": 0.9, "kink_strength": 1.0},
    {"shape": "trilinear", "peak": 0.3, "kink_opening": 0.5, "kink_strength": 0},
    {"shape": "cubic"},
    {"shape": "exponential", "alpha": 0.01},
    {"shape": "exponential", "alpha": 3, "peak": 0.1},
    {"shape": "exponential", "alpha": 100},
]
every = pytest.mark.parametrize("keys", SHAPES, ids=lambda keys: " ".join(str(v) for v in keys.values()))
SIGMA, DELTA = 7.0, 0.03


def of(keys, **numbers):
    return SHAPE.validate_python(keys | (numbers or {"strength": SIGMA, "opening": DELTA}))


def kinks(law):
    """Openings where the slope jumps, as far as a law has them."""
    return [x for name, x in law._asdict().items() if name in ("elastic", "kink", "opening")]


def work(law, opening):
    """∫S dδ by quadrature, piece by piece."""
    ends = [0.0, *(x for x in sorted(kinks(law)) if x < opening), opening]
    pieces = [
        quad(lambda x: envelope(law, x), a, b, epsabs=1e-14, epsrel=1e-13)[0]
        for a, b in itertools.pairwise(ends)
    ]
    return sum(pieces)


@every
def test_toughness_is_the_area(keys):
    shape = of(keys)
    law = shape.parameters()
    assert work(law, DELTA) == pytest.approx(shape.resistance.toughness, rel=1e-11)
    assert shape.area == pytest.approx(work(shape.unit, 1.0), rel=1e-11)
    assert failure(law) == DELTA


@every
def test_strength_is_the_largest_traction(keys):
    law = of(keys).parameters()
    x = np.linspace(0, 1.5 * DELTA, 30001)
    tractions = np.array([envelope(law, each) for each in x])
    assert tractions.max() == pytest.approx(SIGMA, rel=1e-3)
    assert tractions.max() <= SIGMA * (1 + 1e-15)
    assert tractions.min() == 0
    assert not tractions[x >= DELTA].any()


@every
@pytest.mark.parametrize("missing", ["strength", "toughness", "opening"])
def test_third_follows_from_two(keys, missing):
    whole = of(keys).resistance
    two = {name: value for name, value in whole._asdict().items() if name != missing}
    assert of(keys, **two).resistance == pytest.approx(whole, rel=1e-14)
    assert of(keys, **two).parameters() == pytest.approx(of(keys).parameters(), rel=1e-14)


@every
def test_spent_is_work_less_what_unloading_gives_back(keys):
    law = of(keys).parameters()
    before = 0.0
    for opening in np.linspace(1e-4, 1.3, 79) * DELTA:
        given_back = 0.5 * envelope(law, opening) * opening
        expected = work(law, opening) - given_back
        assert spent(law, opening) == pytest.approx(expected, rel=1e-9, abs=1e-14)
        assert spent(law, opening) >= before - 1e-16
        before = spent(law, opening)
    assert spent(law, elastic_end(law)) == pytest.approx(0, abs=1e-17)
    assert spent(law, DELTA) == pytest.approx(of(keys).resistance.toughness, rel=1e-13)


@every
def test_slopes_and_secants(keys):
    shape = of(keys)
    law = shape.parameters()
    h = 1e-7 * DELTA
    for opening in np.linspace(0.003, 1.2, 61) * DELTA:
        if min(abs(opening - x) for x in kinks(law)) > 3 * h:
            slope = (envelope(law, opening + h) - envelope(law, opening - h)) / (2 * h)
            assert envelope_slope(law, opening) == pytest.approx(slope, rel=1e-5, abs=1e-5 * SIGMA / DELTA)
        if opening >= elastic_end(law):
            assert secant(law, opening) == pytest.approx(envelope(law, opening) / opening, rel=1e-13)
    assert envelope_slope(law, 0.0) == pytest.approx(shape.slope, rel=1e-14)
    assert secant(law, max(elastic_end(law), 0.0)) == pytest.approx(shape.slope, rel=1e-14)
    secants = [secant(law, x) for x in np.linspace(elastic_end(law), 1.1 * DELTA, 999)[1:]]
    assert np.all(np.diff(secants) <= 0)


@every
def test_two_of_three_are_needed(keys):
    for numbers in (
        {"strength": 1, "toughness": 1, "opening": 1},
        {"strength": 1},
        {"toughness": 1},
        {"opening": 1},
    ):
        with pytest.raises(ValidationError) as caught:
            SHAPE.validate_python(keys | numbers)
        words = str(caught.value)
        assert "two of strength, toughness and opening" in words
        if len(numbers) == 1:
            missing = [name for name in ("strength", "toughness", "opening") if name not in numbers]
            assert f"missing: {missing[0]} and {missing[1]}" in words
    with pytest.raises(ValidationError, match="missing: strength, toughness and opening"):
        SHAPE.validate_python(keys)


@pytest.mark.parametrize(
    "keys",
    [
        {"shape": "triangular", "peak": 0},
        {"shape": "triangular", "peak": 1},
        {"shape": "triangular", "strength": -1},
        {"shape": "triangular", "alpha": 1},
        {"shape": "cubic", "peak": 0.2},
        {"shape": "exponential"},
        {"shape": "exponential", "alpha": 0},
        {"shape": "exponential", "alpha": -1},
        {"shape": "trilinear", "kink_opening": 0.4},
        {"shape": "trilinear", "kink_opening": 0.2, "kink_strength": 0.4},
        {"shape": "trilinear", "kink_opening": 0.4, "kink_strength": 1.1},
        {"shape": "linear"},
        {"shape": "linear", "stiffness": -1},
        {"shape": "linear", "stiffness": 1, "strength": 2},
        {"shape": "square"},
        {},
    ],
)
def test_refused(keys):
    numbers = {} if keys.get("shape") == "linear" else {"strength": 1, "opening": 1}
    with pytest.raises(ValidationError):
        SHAPE.validate_python(numbers | keys)
