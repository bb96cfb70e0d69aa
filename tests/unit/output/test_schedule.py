"""Due times: none missed by round-off, none repeated, none that bends the step."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpmcli.core.times import is_reached
from mpmcli.output.schedule import Schedule


def times_written(every: float, times: list[float]) -> list[float]:
    schedule, written = Schedule(every), []
    for time in times:
        if schedule.is_due(time):
            written.append(time)
            schedule.advance(time)
    return written


def test_due_times_are_met_in_spite_of_round_off():
    times, time = [0.0], 0.0
    for _ in range(1600):
        time += 1e-4  # accumulates to 0.15999999999999…
        times.append(time)
    assert times[-1] != 0.16
    written = times_written(0.01, times)
    assert len(written) == 17
    assert written == pytest.approx([0.01 * k for k in range(17)], abs=1e-12)


def test_output_comes_at_the_first_step_past_a_due_time():
    assert times_written(1.0, [0.0, 0.7, 1.4, 2.1, 2.8, 3.5]) == [0.0, 1.4, 2.1, 3.5]


def test_due_times_that_a_step_jumps_over_give_one_output():
    assert times_written(0.1, [0.0, 1.05, 1.06, 1.11]) == [0.0, 1.05, 1.11]


def test_output_at_other_times_does_not_shift_the_due_times():
    schedule = Schedule(1.0)
    schedule.advance(0.0)
    schedule.advance(0.4)  # an extra archive, for instance at an interruption
    assert not schedule.is_due(0.9)
    assert schedule.is_due(1.0)


def test_infinite_interval_gives_the_start_only():
    assert times_written(math.inf, [0.0, 1.0, 1e9]) == [0.0]


def test_interval_must_be_positive():
    for every in (0.0, -1.0, math.nan):
        with pytest.raises(ValueError, match="above 0"):
            Schedule(every)


@given(st.floats(1e-6, 1e6), st.integers(1, 10**7))
def test_advancing_at_a_due_time_leads_to_the_next(every, count):
    schedule = Schedule(every)
    schedule.advance(every * count * (1.0 - 1e-12))
    assert schedule.count == count + 1
    assert not schedule.is_due(every * count)


def test_is_reached_has_relative_slack():
    assert is_reached(0.16 * (1 - 1e-12), 0.16)
    assert not is_reached(0.16 * (1 - 1e-6), 0.16)
    assert is_reached(0.0, 0.0)
