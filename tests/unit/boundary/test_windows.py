"""Windows of time of conditions and loads."""

import numpy as np
import pytest
from pydantic import ValidationError

from mpmcli.boundary.clocks import Clock, ClockedLoad
from mpmcli.boundary.gravity import Gravity
from mpmcli.boundary.windowed import WindowedHolder


def weight(**window):
    return Gravity(**{"name": "weight", "acceleration": [0, -2], **window})


def test_a_window_has_its_start_and_not_its_end():
    load = weight(**{"from": 0.3, "until": 0.5})
    step = np.float64(0.1)
    times = np.cumsum(np.full(6, step)) - step  # not the decimal numbers but for round-off
    assert [load.acts_at(float(t)) for t in times] == [False, False, False, True, True, False]
    assert times[3] != 0.3
    assert not load.acts_always
    assert weight().acts_always
    assert not weight(until=9).acts_always


@pytest.mark.parametrize(("begin", "until"), [(1.0, 1.0), (2.0, 1.0), (1.0, 1.0 + 1e-12)])
def test_a_window_ends_after_it_begins(begin, until):
    with pytest.raises(ValidationError, match="must be later than 'from', which is"):
        weight(**{"from": begin, "until": until})


@pytest.mark.parametrize("window", [{"from": -1}, {"until": 0}, {"until": -1}])
def test_windows_lie_within_the_run(window):
    with pytest.raises(ValidationError):
        weight(**window)


@pytest.mark.parametrize(
    ("first", "second", "together", "within"),
    [
        ({}, {"from": 2.0, "until": 3.0}, 2.0, False),
        ({"from": 2.0, "until": 3.0}, {}, 2.0, True),
        ({"until": 2.0}, {"from": 2.0}, None, False),
        ({"from": 1.0, "until": 2.0}, {"from": 0.5, "until": 2.0}, 1.0, True),
        ({"from": 1.0}, {"from": 0.5, "until": 2.0}, 1.0, False),
    ],
)
def test_two_windows(first, second, together, within):
    one, other = weight(**first), weight(**second)
    assert one.first_with(other) == other.first_with(one) == together
    assert one.acts_within(other) == within


def test_a_window_goes_by_the_clock_of_its_load():
    clock = Clock()
    load = ClockedLoad(weight(**{"from": 1.0, "until": 3.0}), clock)
    clock.turn(0.0, 2.0)
    assert load.acts_at(9.0)
    clock.turn(-1.0, 9.0)
    assert load.acts_at(10.0)
    assert not load.acts_at(10.5)


class Everything:
    """A holder of three nodes whose values change, and that must not be asked before time 1."""

    direction, varies = np.array([1.0, 0.0]), True

    def renew(self, active):
        self.active = active

    def key(self, time):
        assert time >= 1.0
        return 0

    def nodes(self, time):
        assert time >= 1.0
        return self.active

    def values(self, time, coordinates):
        assert time >= 1.0
        return time


def test_a_holder_holds_nothing_outside_its_window():
    holder = WindowedHolder(Everything(), weight(**{"from": 1.0, "until": 2.0}))
    holder.renew(np.arange(3))
    assert [holder.key(time) for time in (0.0, 1.0, 1.5, 2.0)] == [None, 0, 0, None]
    assert [len(holder.nodes(time)) for time in (0.0, 1.0, 1.5)] == [0, 3, 3]
    assert [holder.values(time, np.zeros((2, 3))) for time in (0.0, 1.0, 1.5)] == [0.0, 1.0, 1.5]
    assert holder.varies
