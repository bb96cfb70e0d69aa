"""What every registered growth criterion and direction is held to."""

import json
import math
from typing import get_args

import examples
import pytest

from mpmcli.core.model import Varying
from mpmcli.cracks.criteria import CRITERIA, Criterion
from mpmcli.cracks.directions import DIRECTIONS, Direction
from mpmcli.cracks.integrals.elastic import PlaneElasticity
from mpmcli.cracks.tip_state import TipState
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

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


PLATE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-8, -8], upper: [8, 8], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials: {glue: {kind: linear_elastic, density: 1.0e-3, E: 1000, nu: 0.33}}
bodies: [{name: plate, material: glue, region: {kind: box, lower: [-6, -6], upper: [6, 6]}, velocity: [0, y]}]
cracks: [{name: main, path: {kind: points, points: [[-2, 0.5], [1, 0.5]]}}]
fracture: {inner: 1, outer: 3}
time: {end: 0.1, courant: 0.3}
"""
SMALL = {"velocity": 300.0}
"""Values that a tip of the plate soon exceeds, by dimension; others are 1e-6."""


def varying(annotation, metadata=()):
    """The ``Varying`` of a field, also where it may be left out."""
    own = [each for each in (*metadata, *get_args(annotation)) if isinstance(each, Varying)]
    return own + [found for part in get_args(annotation) for found in varying(part)]


def with_all_variables(model, keys):
    """Give every value that may vary an expression of all variables that its key documents."""
    found = dict(keys)
    for name, field in model.model_fields.items():
        for marks in varying(field.annotation, field.metadata)[:1]:
            terms = " + ".join(["1", *(f"0.01*{variable}" for variable in marks.variables)])
            found[name] = f"{SMALL.get(marks.dimension, 1e-6)}*({terms})"
    return found


def grow(criterion, direction=None):
    growth = {"criterion": criterion, "increment": 0.5} | ({"direction": direction} if direction else {})
    simulation = Simulation(load_scene(PLATE, sets=[f"cracks.0.growth.end={json.dumps(growth)}"]), threads=1)
    chain = simulation.cracks.chains[0]
    before = chain.count
    for _ in range(60):
        simulation.step()
        if chain.count > before:
            break
    return chain.count - before


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(CRITERIA))
def test_values_of_criteria_may_depend_on_all_variables_that_they_document(kind):
    keys = with_all_variables(CRITERIA[kind], {"kind": kind} | examples.CRITERIA.get(kind, {}))
    assert (grow(keys) == 0) == (kind == "never")


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(DIRECTIONS))
def test_tips_grow_in_every_direction(kind):
    keys = with_all_variables(DIRECTIONS[kind], {"kind": kind} | examples.DIRECTIONS.get(kind, {}))
    assert grow({"kind": "energy_release_rate", "J_c": "1e-6*(1 + t + length + speed)"}, keys) == 1
