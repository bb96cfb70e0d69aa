"""Tractions on the points of a crack: words, areas, laws, releases, histories that grow and are kept."""

import numpy as np
import pytest
from pydantic import ValidationError

from mpmcli.contact.laws import LAWS
from mpmcli.core.state import CracksView
from mpmcli.cracks.chain import ABOVE, END, START, Chain, with_point
from mpmcli.cracks.model import Crack, Traction
from mpmcli.cracks.tractions import Tractions, areas

STRENGTH, TOUGHNESS, BREADTH = 2.0, 0.5, 3.0
MODE = {"shape": "triangular", "strength": STRENGTH, "toughness": TOUGHNESS, "peak": 0.25}
LAW = {"kind": "cohesive", "normal": MODE, "tangential": MODE}
LAST = 2.0 * TOUGHNESS / STRENGTH


def word(**changes):
    return {
        "name": "c",
        "path": {"kind": "points", "points": [[0, 0], [4, 0]]},
        "traction": {"law": LAW} | changes,
    }


class Forces:
    """Takes forces in."""

    def __init__(self, chain):
        self.chain, self.force = chain, None

    def add_to(self, f, force):
        self.force = force

    def work(self, v, dt):
        return 0.0


def make(count=5, **changes):
    model = Crack.model_validate(word(**changes))
    chain = Chain("c", 0, np.stack([np.arange(count, dtype=float), np.zeros(count)]), (True, True))
    view = CracksView(
        [chain], np.zeros((1, 2)), np.zeros(1), interface_energy=np.zeros(1), cohesive_work=np.zeros(1)
    )
    view.debonded_length = np.zeros(1)
    inside = np.array([[2.0], [0.0]]), np.full((2, 1), 10.0)
    return Tractions([model], [chain], Forces, [inside], BREADTH, {}, view), chain, view


def open_by(chain, opening, slip=0.0):
    chain.faces[ABOVE] = chain.X + np.array([[slip], [opening]])


def test_one_traction_stands_for_a_list():
    assert (
        Crack.model_validate(word()).traction
        == Crack.model_validate(word() | {"traction": [{"law": LAW}]}).traction
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"law": {"kind": "coulomb", "friction": 0.2}}, "'cohesive', not 'coulomb'"),
        ({"law": LAW | {"closed": {"kind": "frictionless"}}}, "leave out 'closed'"),
        ({"law": LAW | {"bonded": "x > 0"}}, "leave out 'bonded'"),
        ({"along": [3, 1]}, "two lengths"),
        ({"along": [-1, 1]}, "two lengths"),
    ],
)
def test_what_points_cannot_have_is_refused(changes, words):
    with pytest.raises(ValidationError, match=words):
        Traction.model_validate({"law": LAW} | changes)


def test_points_lie_where_tractions_begin_and_end():
    corners = with_point(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]), 5.0)
    assert corners.tolist() == [[0, 0], [4, 0], [4, 1], [4, 3]]
    assert len(with_point(corners, 5.0)) == len(with_point(corners, 9.0)) == 4


def test_areas_are_those_between_points_that_carry_something():
    _, chain, _ = make(along=[1, 3])
    assert areas(chain, BREADTH) == pytest.approx([0, 1.5, 3.0, 1.5, 0])
    chain.dry = np.array([1.5, 0.0])
    assert areas(chain, BREADTH).sum() == pytest.approx(1.5 * BREADTH)
    chain.dry[:] = 0.0
    assert areas(chain, None) == pytest.approx([0, 0.5, 2.0, 1.5, 0])  # times the radius


@pytest.mark.slow
@pytest.mark.parametrize("opening", [0.1 * LAST, 0.25 * LAST, 0.7 * LAST])
def test_faces_are_pulled_together_by_the_envelope(opening):
    tractions, chain, _ = make()
    open_by(chain, opening)
    tractions.remember(0.0)
    tractions.add_to(np.zeros((0, 2)))
    found = tractions._of[0].force
    expected = STRENGTH * min(4.0 * opening / LAST, (LAST - opening) / (0.75 * LAST))
    assert found[0].sum(axis=1) == pytest.approx([0.0, -expected * 4.0 * BREADTH])
    assert np.array_equal(found[0], -found[1])
    assert chain.numbers["traction"][1] == pytest.approx(-expected)


@pytest.mark.slow
def test_closed_faces_are_left_to_contact():
    tractions, chain, view = make()
    open_by(chain, -0.1 * LAST)
    tractions.remember(0.0)
    tractions.add_to(np.zeros((0, 2)))
    assert np.all(tractions._of[0].force == 0.0)
    assert view.cohesive_work[0] == view.interface_energy[0] == 0.0


@pytest.mark.slow
def test_what_fails_has_spent_its_toughness_and_is_an_event():
    tractions, chain, view = make()
    for share in np.linspace(0.0, 1.02, 103):
        view.interface_energy[0] = 0.0
        open_by(chain, share * LAST)
        tractions.remember(share)
    assert view.cohesive_work[0] == pytest.approx(TOUGHNESS * 4.0 * BREADTH)
    assert view.debonded_length[0] == pytest.approx(4.0)
    assert view.interface_energy[0] == 0.0
    assert [event[3] for event in view.events] == ["debond"] * 5
    assert view.events[2][4:7] == pytest.approx((2.0, 0.0, TOUGHNESS))
    tractions.add_to(np.zeros((0, 2)))
    assert np.all(tractions._of[0].force == 0.0)
    assert np.all(chain.numbers["damage"] == 1.0)
    open_by(chain, 0.1 * LAST)
    tractions.remember(2.0)
    assert len(view.events) == 5  # once


@pytest.mark.slow
def test_unloading_goes_through_the_origin():
    tractions, chain, view = make()
    open_by(chain, 0.5 * LAST)
    tractions.remember(0.0)
    spent = view.cohesive_work.copy()
    tractions.add_to(np.zeros((0, 2)))
    most = tractions._of[0].force[0, 1].sum()
    open_by(chain, 0.2 * LAST)
    tractions.remember(1.0)
    tractions.add_to(np.zeros((0, 2)))
    assert tractions._of[0].force[0, 1].sum() == pytest.approx(0.4 * most)
    assert view.cohesive_work == spent


@pytest.mark.parametrize("end", [START, END])
def test_growth_leaves_a_law_behind(end):
    tractions, chain, _ = make(along=[1, 3])
    law = tractions.add_law(LAWS["cohesive"].model_validate(LAW))
    new = np.array([[5.0, 6.0] if end == END else [-1.0, -2.0], [0.0, 0.0]])
    chain.extend(end, new)
    tractions.bind(chain, end, 2, law)
    expected = [2, 2, 2, 1, 1, 1, 0] if end == START else [0, 1, 1, 1, 2, 2, 2]
    assert chain.numbers["law"].tolist() == expected
    assert areas(chain, 1.0).sum() == pytest.approx(5.0)


@pytest.mark.slow
@pytest.mark.parametrize("end", [START, END])
def test_a_gradual_release_spends_half_its_traction_times_its_opening(end):
    tractions, chain, view = make(along=[0, 1])
    chain.extend(end, np.array([[5.0, 6.0] if end == END else [-1.0, -2.0], [0.0, 0.0]]))
    chain.numbers["law"][:] = 0
    pull = np.array([0.3, -0.4])
    tractions.hold(chain, end, 2, pull, 0.2)
    tractions.add_to(np.zeros((0, 2)))
    assert tractions._of[0].force[0].sum(axis=1) == pytest.approx(pull * BREADTH)  # one segment between both
    for share in np.linspace(0.0, 1.05, 22):
        chain.faces[ABOVE] = chain.X - share * 0.2 * (pull / 0.5)[:, None]
        tractions.remember(share)
    assert view.cohesive_work[0] == pytest.approx(0.5 * 0.5 * 0.2 * BREADTH)
    assert np.all(chain.numbers["release"] == 0.0)


@pytest.mark.slow
def test_histories_are_kept_and_taken_back():
    tractions, chain, _ = make()
    open_by(chain, 0.6 * LAST)
    tractions.remember(0.0)
    memory = {name: np.array(values) for name, values in chain.memory().items()}
    _, other, _ = make()
    other.recall(memory)
    for name, values in chain.numbers.items():
        assert np.array_equal(other.numbers[name], values)


def test_scenes_without_tractions_carry_nothing():
    chain = Chain("c", 0, np.array([[0.0, 1.0], [0.0, 0.0]]), (True, True))
    assert chain.numbers == {}
    assert set(chain.memory()) == {"X", "faces", "velocity", "length0", "dry", "tips"}
