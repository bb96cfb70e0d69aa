"""The energy watchdog: spurious energy is warned of, and ends a run; losses that nothing accounts for are warned of."""

from types import SimpleNamespace

import numpy as np
import pytest

from mpmcli.core.errors import SimulationError
from mpmcli.materials import MATERIALS
from mpmcli.output.snapshot import Snapshot
from mpmcli.run.api import run
from mpmcli.run.watch import EVERY, EnergyWatch, remedy
from mpmcli.scene.method import Method


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
    assert printed.count("warning: the energy error is 98 % in step 50, time 0.5") == 1
    assert "error: the energy error is 100 % in step 100, time 1" in printed
    assert "try half of time.courant" in printed
    assert (tmp_path / "out" / "failed.vtu").exists()


def test_columns_beyond_all_numbers_end_the_run(loaded, simulation, tmp_path, capfd):
    def overflow():
        loaded.simulation.state.strain_energy_density = lambda: np.array([np.inf, 0.0])

    loaded.at[30] = overflow
    outcome = go(loaded, simulation, tmp_path)
    assert outcome.exit_code == 4
    assert "no number is large enough for strain_energy in step " in capfd.readouterr().err
    assert "inf" not in (tmp_path / "out" / "globals.csv").read_text()
    assert (tmp_path / "out" / "failed.vtu").exists()


def test_a_little_is_warned_of_once(loaded, simulation, tmp_path, capfd):
    speed_up(loaded, 1.002)
    assert go(loaded, simulation, tmp_path).exit_code == 0
    assert capfd.readouterr().err.count("the energy error is") == 1


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


def method_of(**keys):
    return Method.model_validate(keys)


def scene_of(material="neo_hookean", **keys):
    """What the watchdog reads of a scene."""
    matter = {"matter": MATERIALS[material]}
    return SimpleNamespace(method=method_of(**keys), materials=matter, heat=None, contact=None)


LOSS = "more energy is lost than friction, damping, viscosity and plastic flow dissipate"


@pytest.mark.parametrize(
    "transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 3}, {"kind": "xpic", "order": 5}]
)
def test_energy_lost_is_warned_of_once(loaded, simulation, tmp_path, capfd, transfer):
    loaded.scene.method = method_of(transfer=transfer)
    loaded.scene.time.end = 2.0
    speed_up(loaded, 0.99)
    assert go(loaded, simulation, tmp_path).exit_code == 0
    printed = capfd.readouterr().err
    assert printed.count(LOSS) == 1
    assert "warning: energy error -86.6 % in step 100, time 1: " in printed, "the second look that finds it"
    assert LOSS in (tmp_path / "out" / "run.log").read_text(encoding="utf-8")


DISSIPATIVE = [
    {"kind": "fmpm", "order": 1},
    {"kind": "fmpm", "order": 2},
    {"kind": "xpic", "order": 2},
    {"kind": "fmpm", "order": 4, "blend": {"order": 1, "fraction": 0.8}},
]


@pytest.mark.parametrize("transfer", DISSIPATIVE)
def test_losses_of_a_dissipative_transfer_are_no_alarm(loaded, simulation, tmp_path, capfd, transfer):
    loaded.scene.method = method_of(transfer=transfer)
    speed_up(loaded, 0.9)
    assert go(loaded, simulation, tmp_path).exit_code == 0
    assert "loses energy" not in capfd.readouterr().err


@pytest.mark.parametrize("account", ["contact_work", "damping_work"])
def test_energy_that_something_dissipates_is_not_lost(loaded, simulation, account, caplog):
    """What friction and damping take is in the balance, and small errors of large works are no alarm."""
    made = simulation(loaded)
    watch, state = EnergyWatch(made, scene_of(transfer={"kind": "flip"})), made.state
    watch.look()
    state.particles.V *= 0.1
    for look, missing in [(1, 0.0), (2, 0.0), (3, 2.0), (4, 2.0), (5, 2.0)]:
        state.step = look * EVERY
        state.work[account] = 0.99 + (10.0 if look > 2 else 0.0)
        state.work["external_work"] = (10.0 + missing) if look > 2 else 0.0
        watch.look()
    assert not watch.memory()["losses"][1]
    state.work["external_work"] += 8.0
    for look in (6, 7):
        state.step = look * EVERY
        watch.look()
    assert watch.memory()["losses"][1]


def losses_of(simulation, watch, looks=2):
    """Nine tenths of the kinetic energy vanish at once; return the checks in a row that find it, and the alarm."""
    watch.look()
    simulation.state.particles.V *= np.sqrt(0.1)
    for look in range(1, looks + 1):
        simulation.state.step = look * EVERY
        watch.look()
    return list(watch.memory()["losses"])


@pytest.mark.parametrize(("share", "losses"), [(0.5, [2, 1]), (0.8, [0, 0])])
def test_what_cracks_release_is_not_lost(loaded, simulation, share, losses):
    made = simulation(loaded)
    energy = Snapshot(made.state).total_kinetic_energy
    made.state.cracks = SimpleNamespace(released=np.array([0.5, 0.5]) * share * energy)
    assert losses_of(made, EnergyWatch(made, scene_of(transfer={"kind": "flip"}))) == losses


@pytest.mark.parametrize(("times", "losses"), [(3.0, [2, 1]), (4.0, [0, 0])])
def test_a_loss_far_below_what_heat_has_stored_is_no_alarm(loaded, simulation, times, losses):
    made = simulation(loaded)
    particles, energy = made.state.particles, Snapshot(made.state).total_kinetic_energy
    particles.T = np.full(particles.vol0.shape, 400.0)
    made.state.strain_energy_density = lambda: np.full(
        particles.vol0.shape, times * energy / particles.vol0.sum()
    )
    assert losses_of(made, EnergyWatch(made, scene_of(transfer={"kind": "flip"}))) == losses


def test_one_look_below_the_limit_is_no_loss(loaded, simulation):
    made = simulation(loaded)
    watch, state = EnergyWatch(made, scene_of(transfer={"kind": "flip"})), made.state
    watch.look()
    for look, factor in [(1, 0.5), (2, 2.0), (3, 0.5), (4, 2.0)]:
        state.step = look * EVERY
        state.particles.V *= factor
        watch.look()
    assert list(watch.memory()["losses"]) == [0, 0]


FMPM4, FLIP = {"kind": "fmpm", "order": 4}, {"kind": "flip"}
REMEDIES = [
    ({"update": "usf"}, "method.update: usl"),
    ({"update": "usl+", "shape": "ugimp"}, "method.update: usl"),
    ({"update": "usavg", "shape": "ugimp"}, "method.shape: lcpdi"),
    ({"shape": "qcpdi"}, "method.shape: lcpdi"),
    ({"shape": "b2cpdi", "transfer": FLIP}, "method.transfer: {kind: fmpm, order: 4}"),
    ({"shape": "lcpdi", "transfer": FMPM4}, "half of grid.cell"),
    ({"material": "tait_fluid", "shape": "lcpdi"}, "method.shape: b2gimp"),
    ({"material": "ideal_gas", "shape": "b2gimp"}, "method.volumetric: averaged"),
    (
        {"material": "tait_fluid", "shape": "b2gimp", "volumetric": "averaged", "transfer": FMPM4},
        "half of grid.cell",
    ),
]


@pytest.mark.parametrize(("keys", "advice"), REMEDIES)
def test_the_remedy_is_not_what_the_scene_does_already(keys, advice):
    scene = scene_of(**keys)
    assert remedy(scene).startswith(advice)
    assert ("velocity_gradient" in remedy(scene)) == (advice == "half of grid.cell")
    scene.heat = SimpleNamespace(interval="auto")
    assert ("heat.interval: 1" in remedy(scene)) == (advice == "half of grid.cell")
    if advice.startswith(("method.update", "method.shape", "method.volumetric")):
        key, value = advice.removeprefix("method.").split(": ")
        assert getattr(scene.method, key) != value


def test_a_loss_is_remembered(loaded, simulation):
    made = simulation(loaded)
    watch = EnergyWatch(made, scene_of(transfer={"kind": "flip"}))
    watch.look()
    made.state.particles.V *= 0.1
    made.state.step = EVERY
    watch.look()
    memory = watch.memory()
    assert list(memory["losses"]) == [1, 0]
    other = EnergyWatch(made, scene_of(transfer={"kind": "flip"}))
    other.recall(memory)
    made.state.step = 2 * EVERY
    other.look()
    assert list(other.memory()["losses"]) == [2, 1]
    older = EnergyWatch(made, scene_of(transfer={"kind": "flip"}))
    older.recall({name: value for name, value in memory.items() if name != "losses"})
    assert list(older.memory()["losses"]) == [0, 0], "a checkpoint of a version that knew nothing of losses"


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
    with pytest.raises(SimulationError, match="spurious energy"):
        other.look()


@pytest.mark.parametrize(
    ("shape", "advice"), [("lcpdi", "method.shape: b2gimp"), ("ugimp", "half of time.courant")]
)
def test_spurious_energy_of_fluids_is_due_to_domains_that_stretch(loaded, simulation, shape, advice):
    made = simulation(loaded)
    watch, state = EnergyWatch(made, scene_of(material="tait_fluid", shape=shape)), made.state
    for look in (0, 1):
        state.step = look * EVERY
        watch.look()
        state.particles.V *= 10.0
    state.step = 2 * EVERY
    with pytest.raises(SimulationError, match=advice):
        watch.look()


@pytest.mark.parametrize(
    ("three_or_more", "created", "advises"),
    [("lumped", 0.1, True), ("pairs", 0.1, True), ("lumped", 0.0, False), ("coupled", 0.1, False)],
)
def test_spurious_energy_of_lumped_contact_is_named(
    loaded, simulation, caplog, three_or_more, created, advises
):
    made, scene = simulation(loaded), scene_of()
    scene.contact = SimpleNamespace(three_or_more=three_or_more)
    watch, state = EnergyWatch(made, scene), made.state
    state.contact = SimpleNamespace(momentum_error=np.array([0.0, created]))
    for look in (0, 1):
        state.step = look * EVERY
        watch.look()
        state.particles.V *= 10.0
    assert ("contact.three_or_more: coupled" in caplog.text) == advises
    state.step = 2 * EVERY
    with pytest.raises(SimulationError, match="contact.three_or_more" if advises else "half of time.courant"):
        watch.look()


def test_it_looks_at_some_steps_only(loaded, simulation):
    made = simulation(loaded)
    watch = EnergyWatch(made)
    made.state.step = EVERY - 1
    watch.look()
    assert np.isnan(watch.memory()["energies"][0])
