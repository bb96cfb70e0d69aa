"""What ``courant: auto`` takes from step to step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mpmcli.core.analysis import F_COMPONENTS
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.stability.choice import EVERY, RESTS, SOONER, ChosenCourant, free_sides
from mpmcli.stability.scene_limit import SAFETY

SLOW = pytest.mark.slow
INPUTS = Path(__file__).parents[3] / "inputs"


def choice_of(name: str, *sets: str) -> tuple[Simulation, ChosenCourant]:
    simulation = Simulation(load_scene(INPUTS / f"{name}.yaml", sets=["time.courant=auto", *sets]), threads=1)
    return simulation, simulation.courant_choice


@SLOW
def test_a_body_whose_faces_lie_well_takes_longer_steps():
    simulation, choice = choice_of("cantilever_tip_load")
    p = simulation.particles
    at_first = choice.at(0, p, 1.0)
    assert at_first > 1.3 * choice.otherwise
    top = p.X[1].argmax()
    p.X[1, top] += 0.15 * 0.25
    assert choice.at(EVERY, p, 1.0) == at_first
    p.X[1, top] += 0.3 * 0.25
    assert choice.at(EVERY + 1, p, 1.0) == at_first  # not looked at
    remembered = choice.memory()
    assert choice.at(2 * EVERY, p, 1.0) == choice.otherwise  # no longer flat
    choice.recall(remembered)
    assert choice.courant == at_first
    assert "as the faces lie within their cells, 0.381 when they are no longer flat" in choice.in_words()


@SLOW
def test_faces_are_followed_through_their_cells():
    simulation, column = choice_of("column_under_gravity")
    p = simulation.particles
    start = p.X.copy()
    p.X[0] += 5.0  # along the axis between its symmetry planes
    on_a_line = column.at(0, p, 1.0)
    p.X[:] = start
    p.X[1] += 0.5 * 0.5
    amid_a_cell = column.at(EVERY, p, 1.0)
    p.X[1] += 0.5 * 0.5
    assert amid_a_cell < 0.85 * on_a_line
    assert column.at(2 * EVERY, p, 1.0) == on_a_line
    p.V[1] = 0.02  # so fast that it would come to the middle of the cell before it is looked at again
    assert column.at(3 * EVERY, p, 1.0) == on_a_line
    assert 3 * EVERY < column.next_look < 3.5 * EVERY
    p.X[1] += 0.5 * 0.5
    assert column.at(column.next_look, p, 1.0) == column.otherwise > amid_a_cell  # it does not stay there
    p.X[1] += 0.5 * 0.5
    p.V[1] = 0.2  # too fast to be followed
    assert column.at(4 * EVERY, p, 1.0) == column.otherwise
    assert column.next_look == 5 * EVERY


@SLOW
def test_where_particles_are_faster_than_waves_the_number_is_theirs():
    simulation, bar = choice_of("stretched_bar")
    p = simulation.particles
    assert bar.at(1, p, 1.0, 0.5) == bar.courant
    assert bar.at(1, p, 1.0, 1.15) == pytest.approx(1.15 * bar.courant)
    assert bar.at(1, p, 1.0, 1e3) == 1.0


@SLOW
def test_a_resumed_run_takes_the_same_steps():
    def simulation() -> Simulation:
        return Simulation(
            load_scene(INPUTS / "column_under_gravity.yaml", sets=["time.courant=auto"]), threads=1
        )

    first, second = simulation(), simulation()
    first.courant_choice.courant, first.courant_choice.next_look = 0.5, 2 * EVERY  # after a face moved
    first.state.step = EVERY + 3
    second.restore({name: np.array(value) for name, value in first.state_arrays().items()})
    for _ in range(2):
        first.step()
        second.step()
        assert first.state.dt == second.state.dt
    assert second.courant_choice.courant == first.courant_choice.courant == 0.5


@SLOW
def test_whose_faces_are_not_followed():
    # not a box; contact of two, and of a free face with a rigid body; starts fast, but is no box
    for name in ("rolling_disk", "axial_compression", "stick_slip", "two_disks"):
        _, choice = choice_of(name)
        assert choice.faces is None, name
        assert choice.in_words() == ""
        assert choice.courant == choice.otherwise


@SLOW
def test_faces_are_not_followed_where_the_body_is_much_strained():
    simulation, column = choice_of("column_under_gravity")
    p = simulation.particles
    at_first = column.at(0, p, 1.0)
    p.F[F_COMPONENTS[2].index("yy"), 7] = 0.75
    assert column.at(EVERY, p, 1.0) == at_first > column.otherwise
    p.F[F_COMPONENTS[2].index("yy"), 7] = 0.5
    assert column.at(2 * EVERY, p, 1.0) == column.otherwise
    p.F[F_COMPONENTS[2].index("yy"), 7] = 1.3
    assert column.at(3 * EVERY, p, 1.0) == column.otherwise


def struck(place: float, speed: float) -> tuple[ChosenCourant, float]:
    """Blocks of the impact with their struck faces at this place within the cells, and this share of the wave speed."""
    simulation, impact = choice_of("block_impact")
    p, wave_speed = simulation.particles, simulation.wave_speed
    p.X[0] += np.where(p.X[0] > 0.0, place, -place)
    p.V[0] = np.where(np.abs(p.X[0]) < 20.0, speed, 0.1) * wave_speed
    return impact, impact.at(SOONER, p, wave_speed)


@SLOW
def test_faces_that_come_to_rest_have_the_limit_of_their_place():
    impact, amid = struck(0.4, 0.0)
    assert amid < 0.9 * impact.otherwise == pytest.approx(0.9 * SAFETY * 0.4775)
    assert impact.next_look == 2 * SOONER
    impact, on_a_line = struck(0.0, 0.0)
    assert on_a_line == impact.otherwise  # a better place than those that moving blocks pass
    impact, moving = struck(0.4, 1.5 * RESTS)
    assert moving == impact.otherwise
    assert impact.in_words() == "; less where a face comes to rest"
    sets = ["time.courant=auto", "method.shape=ugimp"]
    other = Simulation(load_scene(INPUTS / "block_impact.yaml", sets=sets), threads=1).courant_choice
    assert other.faces is None  # it has the limit of the worst place anyway


def test_which_faces_may_come_to_rest():
    def free(name: str) -> list[tuple[int, int]]:
        scene = load_scene(INPUTS / f"{name}.yaml").scene
        return free_sides(scene, scene.bodies[0])

    assert free("vibrating_bar") == []  # its limit knows of its turning points
    assert free("vibrating_bar_2d") == [
        (0, 1),
        (1, 0),
        (1, 1),
    ]  # what is known of swings is of bars on one axis
    assert free("taylor_bar") == [
        (0, 1),
        (1, 1),
    ]  # its tail and its side, not its axis and its end on the anvil
    assert free("block_impact") == [(0, 0), (0, 1), (1, 0), (1, 1)]


@SLOW
def test_the_end_that_is_held_does_not_lower_the_limit_and_the_free_one_does():
    simulation, choice = choice_of("taylor_bar")
    p, wave_speed = simulation.particles, simulation.wave_speed
    p.X[1] += 0.5 * simulation.grid.cell[1]  # both ends amid cells
    p.V[1] = np.where(p.X[1] < 12.7, 0.0, 0.1 * wave_speed)  # at rest on the anvil
    assert choice.at(SOONER, p, wave_speed) == choice.otherwise
    p.V[:] = 0.0
    assert choice.at(2 * SOONER, p, wave_speed) < 0.9 * choice.otherwise


def test_a_run_that_is_resumed_for_longer_takes_the_steps_of_the_longer_run():
    _, short = choice_of("vibrating_bar", "time.end=400")
    _, long = choice_of("vibrating_bar", "time.end=4000")
    alone = long.at(0, None)
    long.recall(short.memory())
    assert long.at(100, None) == alone < 0.8 * short.at(100, None)


@SLOW
def test_a_resumed_run_goes_on_where_a_face_rests():
    def simulation() -> Simulation:
        return choice_of("block_impact")[0]

    first, second = simulation(), simulation()
    first.courant_choice.courant, first.courant_choice.next_look = 0.39, SOONER  # as with faces at rest
    first.state.step = SOONER - 2
    second.restore({name: np.array(value) for name, value in first.state_arrays().items()})
    for _ in range(4):
        first.step()
        second.step()
        assert first.state.dt == second.state.dt
    assert second.courant_choice.courant == first.courant_choice.courant == first.courant_choice.otherwise


@SLOW
def test_bodies_whose_particles_have_left_the_grid_have_no_faces():
    for name in ("shock_nickel", "column_under_gravity", "block_impact"):  # held along all axes, one, none
        simulation, choice = choice_of(name)
        p = simulation.particles
        p.keep(np.zeros(p.count, dtype=bool))
        assert choice.at(EVERY, p, 1.0) == choice.otherwise, name
