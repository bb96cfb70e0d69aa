"""Predicted stability limits: the matrices are those of the solver, the limits those of the vibrating bar."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mpmcli.core.analysis import ANALYSES
from mpmcli.scene.loader import load_scene
from mpmcli.shapes import SHAPES
from mpmcli.solver.simulation import Simulation
from mpmcli.study import prediction
from mpmcli.study.prediction import BLOCK, Lattice, Prediction, Scheme, predict, predict_lattice

SLOW = pytest.mark.slow
INPUTS = Path(__file__).parents[3] / "inputs"

MEASURED = [  # order, largest stable Courant number of inputs/vibrating_bar.yaml ("mpmcli stability", lcpdi)
    ("flip", 1, 0.855),
    ("fmpm", 1, 0.89),
    ("fmpm", 2, 0.685),
    ("fmpm", 4, 0.54),
    ("fmpm", 8, 0.405),
    ("fmpm", 16, 0.32),
    ("fmpm", 40, 0.27),
]


def lattice(shape: str, dimensions: int = 1, particles: int = 2) -> Lattice:
    entry = SHAPES[shape]
    return Lattice(entry.grid_functions, entry.domain, particles, (1.0,) * dimensions)


@pytest.mark.parametrize(("kind", "order", "measured"), MEASURED)
def test_limits_of_the_vibrating_bar(kind, order, measured):
    found = predict_lattice(lattice("lcpdi"), Scheme(kind, order), with_worst=False)
    assert found.moving == pytest.approx(measured, rel=0.08)


def test_a_body_at_rest_at_the_worst_place_has_the_lower_limit():
    for order in (1, 4, 16):
        found = predict_lattice(lattice("lcpdi"), Scheme("fmpm", order))
        assert 0.6 * found.moving < found.worst < found.moving


def test_order_blend_and_period():
    def limit(**scheme):
        return predict_lattice(lattice("lcpdi"), Scheme("fmpm", **scheme), with_worst=False).moving

    assert limit(order=1) > limit(order=2) > limit(order=4) > limit(order=8)
    assert limit(order=8, blend=(1, 1.0)) == limit(order=8)
    assert limit(order=8, blend=(1, 0.0)) == limit(order=1)
    assert limit(order=8) < limit(order=8, blend=(2, 0.8)) < limit(order=8, blend=(1, 0.8))
    assert limit(order=8, every_steps=1) == limit(order=8)
    assert limit(order=8) < limit(order=8, every_steps=4) < 0.86


def test_what_a_scene_says():
    bar = INPUTS / "vibrating_bar.yaml"
    loaded = load_scene(bar, sets=["method.transfer={kind: flip}"])
    assert predict(loaded.scene, with_worst=False) == Prediction(
        pytest.approx(0.856, abs=0.003), pytest.approx(np.nan, nan_ok=True)
    )
    plane = load_scene(INPUTS / "block_impact.yaml").scene
    (found,) = set(prediction.lattices_of(plane))
    assert found.dimensions == 2
    assert 0.0 < found.shear < 0.5
    assert found.lame + 2 * found.shear == pytest.approx(1.0)


SCENE = """
version: 1
units: {length: m, mass: kg, time: s}
analysis: {kind: KIND}
grid: {lower: LOWER, upper: UPPER, cell: 1}
method: {shape: SHAPE, update: UPDATE, transfer: TRANSFER}
materials: {m: {kind: linear_elastic, density: 1, E: YOUNG, nu: POISSON}}
bodies:
  - {name: b, material: m, region: {kind: box, lower: FROM, upper: TO}, particles_per_axis: 2, velocity: VELOCITY}
time: {end: 10, courant: 0.4}
"""
TINY = 1e-8


def simulated(dimensions: int, shape: str, update: str, transfer: str, offset: float):
    """A free block, shifted within its cells, with tiny random velocities."""
    L = BLOCK[dimensions]
    kind = {1: "uniaxial_stress", 2: "plane_strain"}[dimensions]
    poisson = {1: 0.0, 2: 0.25}[dimensions]
    young = (1 + poisson) * (1 - 2 * poisson) / (1 - poisson)
    values = {
        "KIND": kind,
        "LOWER": [-5] * dimensions,
        "UPPER": [L + 5] * dimensions,
        "SHAPE": shape,
        "UPDATE": update,
        "TRANSFER": transfer,
        "YOUNG": young,
        "POISSON": poisson,
        "FROM": [0] * dimensions,
        "TO": [L] * dimensions,
        "VELOCITY": [0] * dimensions,
    }
    text = SCENE
    for name, value in values.items():
        text = text.replace(name, str(value))
    simulation = Simulation(load_scene(text), threads=1)
    p = simulation.particles
    # memory order as the lattice has it: the last axis fastest
    order = np.lexsort(p.X[::-1])
    V = np.random.default_rng(1).normal(size=p.V.shape)
    p.V[:, order] = TINY * V
    p.X += offset
    simulation.order.drift = np.inf
    ids = p.id[order].copy()
    return simulation, V, ids


CASES = [
    (1, "lcpdi", "usl", "{kind: flip}", Scheme()),
    (1, "lcpdi", "usl", "{kind: fmpm, order: 3}", Scheme("fmpm", 3)),
    (1, "lcpdi", "usl+", "{kind: fmpm, order: 3}", Scheme("fmpm", 3, "usl+")),
    (1, "lcpdi", "usavg", "{kind: fmpm, order: 2}", Scheme("fmpm", 2, "usavg")),
    (1, "lcpdi", "usl", "{kind: xpic, order: 3}", Scheme("xpic", 3)),
    (1, "lcpdi", "usf", "{kind: flip}", Scheme(update="usf")),
    pytest.param(1, "b2gimp", "usl", "{kind: fmpm, order: 2}", Scheme("fmpm", 2), marks=SLOW),
    pytest.param(1, "ugimp", "usl", "{kind: flip}", Scheme(), marks=SLOW),
    pytest.param(2, "lcpdi", "usl", "{kind: fmpm, order: 2}", Scheme("fmpm", 2), marks=SLOW),
]


@pytest.mark.parametrize(("dimensions", "shape", "update", "transfer", "scheme"), CASES)
def test_the_matrices_are_those_of_the_solver(dimensions, shape, update, transfer, scheme):
    offset, courant = 0.3, 0.4
    simulation, V, ids = simulated(dimensions, shape, update, transfer, offset)
    mu = {1: 0.0, 2: 1.0 / 3.0}[dimensions]
    block = lattice(shape, dimensions)
    block = Lattice(block.grid_functions, block.domain, 2, block.cell, 1 - 2 * mu, mu)
    step = prediction._Update(block, scheme, courant)
    N = V.shape[1]
    state = prediction._State(V[..., None].copy(), np.zeros((len(step.pairs), N, 1)), None)
    for _ in range(3):
        simulation.step()
        step.advance(state, prediction._stencils(block, offset))
    p = simulation.particles
    place = np.argsort(p.id)[ids]
    assert p.V[:, place] / TINY == pytest.approx(state.V[..., 0], abs=1e-5)
    stresses = p.tau[:, place] / TINY
    analysis = ANALYSES[{1: "uniaxial_stress", 2: "plane_strain"}[dimensions]]()
    assert analysis.dimensions == dimensions
    rows = {1: [0], 2: [0, 3, 1]}[dimensions]
    assert stresses[rows] == pytest.approx(state.stress[..., 0], abs=1e-5)
    assert np.abs(stresses[rows]).max() > 0.05


def test_functions_of_the_axes_sum_to_one():
    for name, entry in SHAPES.items():
        S, G, reach = prediction._axis(entry.grid_functions, entry.domain, 2, 3, 0.37)
        assert S.sum(axis=1) == pytest.approx(1.0), name
        assert G.sum(axis=1) == pytest.approx(0.0, abs=1e-8), name
        assert reach.sum(axis=1) == pytest.approx(0.0, abs=1e-8), name
