"""Respacing of chains: which segments are divided or joined, and what points carry."""

import numpy as np
import pytest

from mpmcli.cracks.chain import END, START, Chain, respaced, segment_lengths, turns
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation


def chain_of(*x, tips=(True, True)):
    return Chain("c", 0, np.stack([np.array(x), np.zeros(len(x))]), tips)


def test_long_segments_are_divided_and_short_ones_joined():
    chain = chain_of(0.0, 1.0, 2.0, 3.0, 4.0)
    chain.X[0] = [0.0, 1.0, 2.6, 2.8, 4.0]
    assert respaced(chain).tolist() == [0.0, 1.0, 1.5, 2.0, 4.0]  # the one before the longer segment stays
    chain.put_points(respaced(chain))
    assert chain.X[0].tolist() == pytest.approx([0.0, 1.0, 1.8, 2.6, 4.0])
    assert chain.length0.tolist() == [1.0] * 4
    assert respaced(chain).tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]  # no more


@pytest.mark.parametrize("stretch", [8.0, 0.03])
def test_a_chain_that_stretches_keeps_its_spacing(stretch):
    chain = chain_of(*np.arange(41.0))
    for _ in range(100):
        chain.X = chain.X * stretch**0.01
        chain.put_points(respaced(chain))
        length = segment_lengths(chain.X)
        assert length.max() <= 1.5 * 1.03
        assert length.min() >= 0.24
        assert (chain.X[0, START], chain.X[0, END]) == (0.0, pytest.approx(chain.length))
    assert chain.length == pytest.approx(40.0 * stretch)


def test_ends_stay():
    chain = chain_of(0.0, 1.0, tips=(False, True))
    chain.X[0, 1] = 0.1
    assert respaced(chain).tolist() == [0.0, 1.0]


def test_all_that_points_carry_is_interpolated():
    chain = chain_of(0.0, 1.0, 2.0)
    chain.faces[0, 1] = [0.0, 0.2, 0.6]
    chain.velocity[1, 0] = [1.0, 2.0, 3.0]
    chain.numbers = {"law": np.array([1, 1, 0]), "damage": np.array([0.0, 0.5, 1.0])}
    chain.dry = np.array([0.5, 0.25])
    chain.put_points(np.array([0.0, 0.5, 1.0, 1.5, 2.0]))
    assert chain.faces[0, 1].tolist() == pytest.approx([0.0, 0.1, 0.2, 0.4, 0.6])
    assert chain.velocity[1, 0].tolist() == [1.0, 1.5, 2.0, 2.5, 3.0]
    assert chain.numbers["damage"].tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert chain.numbers["law"].tolist() == [1, 1, 1, 1, 0]
    assert chain.dry.tolist() == [1.0, 0.5]  # the same places
    chain.put_points(np.array([1.0, 2.0, 3.0, 4.0]))
    assert chain.dry.tolist() == [0.0, 0.5]


def test_turns():
    X = np.array([[0.0, 1.0, 1.0, 0.5, 0.5], [0.0, 0.0, 1.0, 1.0, 1.0]])
    assert turns(X, 0.0).tolist() == pytest.approx([0.0, 0.0, 1.0])
    back = np.array([[0.0, 1.0, 0.5, 0.8, 2.0], [0.0, 0.0, 0.0, 0.0, 0.0]])
    assert turns(back, 0.0).tolist() == pytest.approx([-1.0, -1.0, 1.0])
    assert turns(back, 0.4).tolist() == pytest.approx([-1.0, 1.0, 1.0])


DRAWN = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-6, -3], upper: [14, 3], cell: 0.5}
method: {shape: lcpdi, transfer: {kind: flip}}
materials: {m: {kind: neo_hookean, E: 10, nu: 0.3, density: 0.001}}
bodies:
  - {name: bar, material: m, region: {kind: box, lower: [-4, -1], upper: [4, 1]}, velocity: ["300*(x + 4)/8", 0]}
cracks:
  - name: main
    path: {kind: points, points: [[-3, 0.1], [3, 0.1]]}
    respace: true
    traction:
      law: {kind: cohesive, normal: {shape: triangular, strength: 3, toughness: 1},
        tangential: {shape: triangular, strength: 3, toughness: 1}}
time: {end: 0.03, courant: 0.2}
"""


@pytest.mark.slow
def test_a_run_with_respacing_goes_on_from_its_state_with_the_same_bytes():
    one, two = (Simulation(load_scene(DRAWN), threads=1) for _ in range(2))
    chain, before = one.cracks.chains[0], one.cracks.chains[0].count
    while chain.count == before:
        one.step()
    memory = {name: np.copy(value) for name, value in one.state_arrays().items()}
    two.restore(memory)
    for simulation in (one, two):
        for _ in range(20):
            simulation.step()
    again = two.cracks.chains[0]
    assert chain.count > before
    assert segment_lengths(chain.X).max() < 1.5 * 0.25 * 1.05
    for name, value in chain.memory().items():
        assert np.array_equal(value, again.memory()[name])
    assert np.array_equal(one.particles.X, two.particles.X)
    assert len(chain.numbers["law"]) == chain.count
    assert (chain.numbers["law"] == 1).all()
