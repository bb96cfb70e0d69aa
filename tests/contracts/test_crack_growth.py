"""What every registered growth criterion and direction is held to."""

import math

import examples
import pytest

from mpmcli.cracks.criteria import CRITERIA, Criterion
from mpmcli.cracks.directions import DIRECTIONS, Direction
from mpmcli.cracks.integrals.elastic import PlaneElasticity
from mpmcli.cracks.tip_state import TipState

NEEDS = {"J", "K", "opening"}
LOADED = TipState(
    time=1.0, length=2.0, speed=0.1, J=1.0, K_I=1.0, K_II=0.4, elasticity=PlaneElasticity(3.0, 1.8), opening=0.02,
    slip=0.01, angle=0.3, angle0=0.2, last=0.5, started=0.5, increment=0.1,
)  # fmt: skip
TWICE = LOADED._replace(J=4.0, K_I=2.0, K_II=0.8, opening=0.04, slip=0.02)
MIRRORED = LOADED._replace(K_II=-0.4, slip=-0.01)


def made(registry, table, kind):
    return registry[kind].model_validate({"kind": kind, **table.get(kind, {})})


@pytest.fixture(params=list(CRITERIA))
def criterion(request):
    return made(CRITERIA, examples.CRITERIA, request.param)


@pytest.fixture(params=list(DIRECTIONS))
def direction(request):
    return made(DIRECTIONS, examples.DIRECTIONS, request.param)


def test_criterion(criterion):
    assert isinstance(criterion, Criterion)
    assert criterion.needs <= NEEDS
    assert criterion.direction in DIRECTIONS
    assert criterion.demand(LOADED) >= 0.0
    assert criterion.demand(TWICE) >= criterion.demand(LOADED)
    assert criterion.demand(MIRRORED) == pytest.approx(criterion.demand(LOADED), rel=1e-12)
    assert math.isfinite(criterion.moment(LOADED))
    assert criterion.moment(LOADED) <= LOADED.time or criterion.demand(LOADED) < 1.0


def test_criterion_without_what_it_needs_never_grows(criterion):
    """Nothing at the tip, or numbers that are not known, are no reason to grow."""
    rest = TipState(time=0.0, length=1.0, increment=0.1)
    assert not criterion.demand(rest) >= 1.0


def test_direction(direction):
    assert isinstance(direction, Direction)
    assert direction.needs <= NEEDS
    assert math.isfinite(direction.angle(LOADED))
    assert direction.angle(TWICE) == pytest.approx(direction.angle(LOADED), abs=1e-6)


@pytest.mark.parametrize("kind", [k for k in DIRECTIONS if k not in ("given", "initial", "weak_plane")])
def test_mirrored_loads_give_mirrored_directions(kind):
    """All but those that name a direction in space."""
    direction = made(DIRECTIONS, examples.DIRECTIONS, kind)
    assert direction.angle(MIRRORED) == pytest.approx(-direction.angle(LOADED))
