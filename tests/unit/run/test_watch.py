"""The energy watchdog: energy from nowhere is warned of, and ends a run; losses are no alarm."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcli.core.errors import SimulationError
from mpmcli.run.api import run
from mpmcli.run.watch import EVERY, EnergyWatch


def speed_up(loaded, factor, each=1):
    """Particles become faster by a factor in every step, without any force."""
    for step in range(0, 100, each):
        loaded.at[step] = lambda: loaded.simulation.state.particles.V.__imul__(factor)


def go(loaded, simulation, tmp_path):
    return run(loaded, tmp_path / "out", make_simulation=simulation, progress=False)


def test_energy_from_nowhere_ends_the_run(loaded, simulation, tmp_path, capfd):
    speed_up(loaded, 1.04)
    outcome = go(loaded, simulation, tmp_path)
    assert outcome.exit_code == 4
    assert outcome.steps == 2 * EVERY, "the second look at which nine tenths of the energy came from nowhere"
    printed = capfd.readouterr().err
    assert printed.count("warning: the energy error has grown to 98 % in step 50, time 0.5") == 1
    assert "error: the energy error has grown to 100 % in step 100, time 1" in printed
    assert "try half of time.courant" in printed
    assert (tmp_path / "out" / "failed.vtu").exists()


def test_a_little_is_warned_of_once(loaded, simulation, tmp_path, capfd):
    speed_up(loaded, 1.002)
    assert go(loaded, simulation, tmp_path).exit_code == 0
    assert capfd.readouterr().err.count("energy error has grown") == 1


def test_an_error_that_falls_from_the_first_look_on_is_none(loaded, simulation):
    """Bodies that begin at rest: next to no energy at first, of which a small part came from nowhere."""
    made = simulation(loaded)
    watch = EnergyWatch(made)
    for step, error in [(0, 0.0), (EVERY, 0.05), (2 * EVERY, 0.03), (3 * EVERY, 0.02)]:
        made.state.step = step
        watch._balance.update = lambda snapshot, error=error: error
        watch.look()
    assert not watch.memory()["alarms"][1]
    made.state.step = 4 * EVERY
    watch._balance.update = lambda snapshot: 0.025
    watch.look()
    assert watch.memory()["alarms"][1]
    assert watch.memory()["error_before"] == 0.025


def test_losses_are_no_alarm(loaded, simulation, tmp_path, capfd):
    speed_up(loaded, 0.9)
    assert go(loaded, simulation, tmp_path).exit_code == 0
    assert "energy error" not in capfd.readouterr().err.replace(", energy error", "")


def test_it_goes_on_from_what_it_remembers(loaded, simulation):
    made = simulation(loaded)
    watch = EnergyWatch(made)
    watch.look()
    made.state.particles.V *= 10.0
    made.state.step = EVERY
    watch.look()
    other = EnergyWatch(made)
    other.recall(watch.memory())
    np.testing.assert_array_equal(other.memory()["energies"], watch.memory()["energies"])
    made.state.step = 2 * EVERY
    with pytest.raises(SimulationError, match="come from nowhere"):
        other.look()


def test_it_looks_at_some_steps_only(loaded, simulation):
    made = simulation(loaded)
    watch = EnergyWatch(made)
    made.state.step = EVERY - 1
    watch.look()
    assert np.isnan(watch.memory()["energies"][0])
