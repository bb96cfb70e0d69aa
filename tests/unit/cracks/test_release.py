"""Tractions that hold new segments: what they take, what becomes of them, what is remembered."""

import numpy as np
import pytest

from mpmcli.cracks.chain import END, START, Chain
from mpmcli.cracks.release import AREA, NORMAL, REACH, TANGENTIAL, GradualRelease, held, hold_new_segments


def grown(end=END, parts=2, traction=(3.0, 4.0), J=1.0):
    chain = Chain("main", 0, np.array([[0.0, 1.0, 2.0], [0.0] * 3]), (True, True))
    GradualRelease([chain], lambda chain: None, 1.0, {})
    x = 2.0 + 0.25 * np.arange(1, parts + 1) if end == END else -0.25 * np.arange(1, parts + 1)
    chain.extend(end, np.stack([x, 0.0 * x]))
    hold_new_segments(chain, end, parts, J, traction)
    return chain


@pytest.mark.parametrize("end", [START, END])
def test_points_behind_a_new_tip_are_held(end):
    chain = grown(end)
    expected = [0.0, 0.25, 0.25, 0.0, 0.0] if end == START else [0.0, 0.0, 0.25, 0.25, 0.0]
    assert chain.numbers["hold"][AREA] == pytest.approx(expected)
    here = chain.numbers["hold"][AREA] > 0.0
    assert (chain.numbers["hold"][NORMAL][here] == 3.0).all()
    assert (chain.numbers["hold"][TANGENTIAL][here] == 4.0).all()
    assert chain.numbers["hold"][REACH][here] == pytest.approx(2.0 * 1.0 / 5.0)


def test_the_work_of_tractions_is_the_energy_that_is_released():
    """The faces of a held point part along the traction; those of the others stay closed."""
    chain, work, before = grown(parts=1), 0.0, 0.0
    way = np.array([4.0, 3.0]) / 5.0  # slip along x, opening along y
    for size in np.linspace(0.0, 0.5, 2001):
        chain.faces[0, :, 2] = chain.X[:, 2] + size * way
        force = held(chain, 2.0)
        assert force[0] == pytest.approx(-force[1])
        work -= float(force[0, :, 2] @ way) * (size - before)
        before = size
    assert work == pytest.approx(1.0 * 0.25 * 2.0, rel=2e-3)  # J times the new area
    assert not chain.numbers["hold"][AREA].any()
    assert not held(chain, 2.0).any()


def test_faces_that_close_are_pulled_less():
    chain = grown(parts=1, traction=(5.0, 0.0))
    forces = []
    for opening in (0.2, 0.1, 0.2, 0.0):
        chain.faces[0, 1, 2] = opening
        forces.append(-held(chain, 1.0)[0, 1, 2])
    assert forces == pytest.approx([0.25 * 2.5, 0.25 * 1.25, 0.25 * 2.5, 0.0])


def test_around_an_axis_forces_grow_with_the_radius():
    chain = grown(parts=1, traction=(5.0, 0.0))
    assert held(chain, None)[0, 1, 2] == pytest.approx(-0.25 * 5.0 * 2.0)


def test_nothing_is_held_without_traction_or_energy():
    assert not grown(traction=(0.0, 0.0)).numbers["hold"].any()
    assert not grown(J=-1.0).numbers["hold"].any()


def test_memory():
    chain = grown()
    memory = {name: np.copy(value) for name, value in chain.memory().items()}
    again = Chain("main", 0, np.array([[0.0, 1.0], [0.0, 0.0]]), (True, True))
    GradualRelease([again], lambda chain: None, 1.0, {})
    again.recall(memory)
    assert np.array_equal(again.numbers["hold"], chain.numbers["hold"])
