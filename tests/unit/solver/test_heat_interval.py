"""How often heat is conducted, and the Fourier limit of the time step."""

import numpy as np
import pytest
import yaml

from mpmcli.core.errors import SimulationError
from mpmcli.scene.loader import load_scene
from mpmcli.solver.courant import TimeStep
from mpmcli.solver.heat_interval import HeatInterval, HeatLimit
from mpmcli.solver.simulation import Simulation
from mpmcli.stability.heat import MOST_CELLS, MOST_STEPS, largest_interval


class Particles:
    """Materials and J of some particles; counts how often J is asked for."""

    def __init__(self, material, J):
        self.material, self.J, self.asked = np.array(material), np.array(J, dtype=float), 0

    def determinant(self):
        self.asked += 1
        return self.J


def limit_of(fourier=0.25, cell=2.0, diffusivities=(1.0,), ratio=1.0, material=(0,), J=(1.0,)):
    particles = Particles(material, J)
    return HeatLimit(fourier, cell, np.array(diffusivities), ratio, particles), particles


class Motion:
    """How fast particles are, and whether friction heats them."""

    def __init__(self, speed=0.0, has_friction=False):
        self.speed, self.has_friction = speed, has_friction


def interval_of(asked, limit, cell=1.0, motion=None):
    motion = motion or Motion()
    interval = HeatInterval(asked, limit, cell, lambda: motion.speed)
    interval.has_friction = lambda: motion.has_friction
    return interval


def times_of(interval, steps, dt):
    return [interval.advance(dt) for _ in range(steps)]


# ---------------------------------------------------------------- how often


def test_as_seldom_as_the_limit_allows():
    assert largest_interval(0.1, 1.0, 0.0, 1.0) == 10
    assert largest_interval(0.1, 0.99, 0.0, 1.0) == 9
    assert largest_interval(1.0, 0.3, 0.0, 1.0) == 1


def test_nobody_moves_more_than_half_a_cell_between_heat_steps():
    assert largest_interval(0.01, 1e9, 2.0, 1.0) == 25
    assert largest_interval(0.01, 1e9, 1e4, 1.0) == 1


def test_at_most_a_hundred_steps():
    assert largest_interval(1e-12, 1e9, 0.0, 1.0) == MOST_STEPS == 100
    assert largest_interval(5e-324, 1e300, 0.0, 1.0) == MOST_STEPS


@pytest.mark.parametrize("dt", [0.1, 0.25, 0.0137, 1e-3])
@pytest.mark.parametrize("speed", [0.0, 0.3, 7.0])
def test_steps_of_one_size_have_the_largest_interval(dt, speed):
    limit, _ = limit_of(fourier=0.25, cell=2.0)
    n = largest_interval(dt, 1.0, speed, 2.0)
    times = times_of(interval_of(None, limit, 2.0, Motion(speed)), 3 * n, dt)
    assert [i for i, time in enumerate(times) if time] == [n - 1, 2 * n - 1, 3 * n - 1]
    assert times[n - 1] == pytest.approx(n * dt, rel=1e-12)
    assert times[n - 1] <= 1.0 * (1 + 1e-9)
    assert n == 1 or n * dt * speed <= MOST_CELLS * 2.0 * (1 + 1e-9)


def test_a_fixed_interval_takes_all_the_time_since_the_last_heat_step():
    limit, particles = limit_of()
    interval = interval_of(3, limit, motion=Motion(100.0))
    assert [interval.advance(dt) for dt in (1.0, 2.0, 4.0, 8.0, 16.0, 32.0)] == [0, 0, 7, 0, 0, 56]
    assert particles.asked == 0


def test_an_interval_of_one_is_the_step_itself():
    limit, _ = limit_of()
    assert times_of(interval_of(1, limit), 3, 0.1) == [0.1, 0.1, 0.1]


def test_a_body_that_starts_to_move_shortens_the_interval():
    limit, _ = limit_of(fourier=1e9)
    motion = Motion()
    interval = interval_of(None, limit, motion=motion)
    speeds, acted = [0.0] * 150 + [5.0] * 12, []
    for i, motion.speed in enumerate(speeds):
        if interval.advance(0.01):
            acted.append(i)
    assert acted[0] == 99  # the hundredth step
    assert acted[1] <= 160  # 10 steps of 0.05 cells
    paths = np.split(0.01 * np.array(speeds), [i + 1 for i in acted])
    assert len(acted) > 1
    assert max(path.sum() for path in paths) <= MOST_CELLS * (1 + 1e-9)


def test_friction_ends_the_wait_at_once():
    limit, _ = limit_of(fourier=1e9)
    motion = Motion()
    interval = interval_of(None, limit, motion=motion)
    times_of(interval, 5, 0.1)
    motion.has_friction = True
    assert interval.advance(0.1) == pytest.approx(0.6)
    motion.has_friction = False
    assert interval.advance(0.1) == 0.0


@pytest.mark.parametrize("asked", [None, 7])
def test_a_resumed_run_acts_in_the_same_steps(asked):
    limits = [limit_of(ratio=1e3)[0] for _ in range(3)]
    whole, first, second = (interval_of(asked, limit, 2.0, Motion(0.4)) for limit in limits)
    dts = 0.05 + 0.02 * np.sin(np.arange(60))
    expected = [whole.advance(dt) for dt in dts]
    found = [first.advance(dt) for dt in dts[:33]]
    second.recall({name: np.array(value) for name, value in first.memory().items()})
    assert found + [second.advance(dt) for dt in dts[33:]] == expected
    assert any(expected)


# ---------------------------------------------------------------- how long


def test_the_fourier_limit_has_the_smallest_cell_and_the_largest_diffusivity():
    limit, _ = limit_of(0.25, 2.0, [0.5, 8.0, 100.0], 1.0, [0, 1, 1], [1.0, 1.0, 1.0])
    assert limit.shorten(1.0) == pytest.approx(0.25 * 4.0 / 8.0)  # no particle has the third material
    assert limit.shorten(0.1) == 0.1


def test_expanded_particles_conduct_faster():
    limit, _ = limit_of(0.25, 2.0, [0.5, 8.0], 10.0, [0, 1, 1], [9.0, 0.5, 2.0])
    assert limit.shorten(1.0) == pytest.approx(0.25 * 4.0 / 16.0)


def test_volumes_are_evaluated_only_where_they_can_matter():
    limit, particles = limit_of(0.25, 2.0, [1.0], 1000.0, [0], [1.0])
    assert limit.shorten(0.9e-3) == 0.9e-3
    assert particles.asked == 0
    assert limit.shorten(1.1e-3) == 1.1e-3
    assert particles.asked == 1


def test_volumes_are_evaluated_once_in_ten_steps():
    limit, particles = limit_of(0.25, 2.0, [1.0], 1000.0, [0], [1.0])
    interval = interval_of(1, limit)
    for step in range(41):
        particles.J[:] = 1.0 + 0.1 * step
        assert interval.shorten(5.0) == pytest.approx(1.0 / (1.0 + step // 10))
        interval.advance(0.1)
    assert particles.asked == 5


def test_without_conductivity_there_is_no_limit():
    limit, particles = limit_of(diffusivities=[0.0], ratio=1e3)
    assert limit.shorten(1e300) == 1e300
    assert particles.asked == 0


def test_a_step_of_a_courant_number_is_shortened():
    limit, _ = limit_of()  # 1.0
    for asked, longest in ((1, 1.0), (4, 0.25), (None, 1.0)):
        assert TimeStep(None, 0.5, 2.0, interval_of(asked, limit)).choose(0.1, 0.0) == pytest.approx(longest)
        assert TimeStep(None, 0.5, 2.0, interval_of(asked, limit)).choose(10.0, 0.0) == 0.1


def test_the_courant_number_of_a_shortened_step_is_its_own():
    step = TimeStep(None, 0.5, 2.0, interval_of(1, limit_of()[0]))
    step.choose(0.1, 0.0)
    assert step.courant_of_step == pytest.approx(0.05)


def test_a_fixed_step_is_not_shortened():
    limit, particles = limit_of()
    assert TimeStep(7.0, None, 2.0, interval_of(1, limit)).choose(0.1, 0.0) == 7.0
    assert particles.asked == 0


def test_a_body_without_waves_has_the_fourier_limit():
    limit, _ = limit_of()
    assert TimeStep(None, 0.5, 2.0, interval_of(1, limit)).choose(0.0, 0.0) == pytest.approx(1.0)
    with pytest.raises(SimulationError, match="not finite"):
        TimeStep(None, 0.5, 2.0).choose(0.0, 0.0)


# ---------------------------------------------------------------- in runs

WARM_BAR = {
    "version": 1,
    "analysis": {"kind": "uniaxial_strain"},
    "grid": {"lower": [-2], "upper": [22], "cell": 1},
    "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
    "heat": {},
    "materials": {
        "m": {
            "kind": "linear_elastic",
            "density": 2,
            "E": 2,
            "nu": 0,
            "heat_capacity": 0.5,
            "conductivity": 1,
        }
    },
    "bodies": [
        {
            "name": "bar",
            "material": "m",
            "region": {"kind": "box", "lower": [0], "upper": [20]},
            "temperature": "300 + cos(pi*x/20)",
        }
    ],
    "time": {"end": 10},
}


def run_of(heat, **time):
    return Simulation(load_scene(yaml.safe_dump(WARM_BAR | {"heat": heat, "time": {"end": 10} | time})), 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("heat", "time", "dt", "interval"),
    [
        ({}, {"courant": 0.2}, 0.2, 1),
        ({}, {"courant": 0.9}, 0.25, 1),
        ({"fourier": 0.1}, {"courant": 0.9}, 0.1, 1),
        ({"interval": 4}, {"courant": 0.9}, 0.0625, 4),
        ({"interval": 4}, {"step": 0.1}, 0.1, 4),
        ({"interval": "auto"}, {"courant": 0.05}, 0.05, 5),
        ({"interval": "auto"}, {"step": 0.1}, 0.1, 2),
    ],
)
def test_runs_keep_the_limit_and_the_interval(heat, time, dt, interval):
    simulation = run_of(heat, **time)
    for step in range(1, 2 * interval + 1):
        before = simulation.particles.T.copy()
        simulation.step()
        assert simulation.state.dt == pytest.approx(dt, rel=1e-6)
        assert (simulation.particles.T != before).any() == (step % interval == 0)
    assert simulation.heat.elapsed == pytest.approx(interval * dt, rel=1e-6)


@pytest.mark.slow
def test_a_run_goes_on_from_between_heat_steps():
    whole, first, second = (run_of({"interval": "auto"}, courant=0.05) for _ in range(3))
    for _ in range(13):
        whole.step()
    for _ in range(7):
        first.step()
    second.restore({name: np.array(value) for name, value in first.state_arrays().items()})
    for _ in range(6):
        second.step()
    assert np.array_equal(whole.particles.T, second.particles.T)
    assert np.array_equal(whole.particles.T_carried, second.particles.T_carried)


def sliding(name, lower, upper, velocity):
    region = {"kind": "box", "lower": [lower, 0], "upper": [upper, 3]}
    return {"name": name, "material": "m", "region": region, "velocity": velocity}


@pytest.mark.slow
@pytest.mark.parametrize("friction", [True, False])
def test_heat_acts_in_every_step_while_bodies_are_in_contact(friction):
    """The work of friction is known in its own step only."""
    changes = {
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-2, -3], "upper": [16, 6], "cell": 1},
        "heat": {"interval": "auto", "friction": friction},
        "bodies": [sliding("a", 1, 4, [0, 0.3]), sliding("b", 10, 13, [-1.0, 0])],
        "contact": {"law": {"kind": "coulomb", "friction": 0.3}},
        "time": {"end": 10, "step": 0.05},
    }
    simulation = Simulation(load_scene(yaml.safe_dump(WARM_BAR | changes)), 1)
    waited = {True: 0, False: 0}
    for _ in range(140):
        simulation.step()
        meets = simulation.contact.contacts.count > 0
        waited[meets] += simulation.heat.elapsed == 0.0
    assert waited[False] > 10
    assert (waited[True] == 0) == friction
    work = simulation.state.work
    assert work["contact_work"] > 0.0
    assert work.get("friction_heat") == (pytest.approx(work["contact_work"]) if friction else None)
