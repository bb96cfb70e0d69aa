"""Runs that fail say what, when and where; particles that leave follow the scene's policy."""

import re

import numpy as np
import pytest
import yaml

from mpmcli.core.errors import SceneError, SimulationError
from mpmcli.geometry import fill
from mpmcli.scene import checks, filling
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import GOOD_EVERY, Simulation


def failure_of(run, steps=400) -> SimulationError:
    with pytest.raises(SimulationError) as caught:
        run.steps(steps)
    return caught.value


PLACE = r"particle \d+ of body '\w+' at \([^)]*\), cell \(-?\d+, -?\d+\), in step \d+, time [\d.e+-]+"


def test_a_step_too_long_ends_with_words(block):
    error = failure_of(block(time={"end": 100, "step": 0.5}, bodies__0__velocity=["-x", "0.5*y"]))
    words = str(error)
    assert re.search(PLACE, words), words
    assert re.search(r"J = |not finite|left the grid|would move by", words)
    assert error.exit_code == 4


def test_a_failure_in_the_first_step_names_the_step_that_failed(block):
    """Not the one before, which there was not."""
    run = block(time={"end": 100, "step": 3.0}, bodies__0__velocity=["-40*x", "0"])
    words = str(failure_of(run, 1))
    assert "in step 1, time 0" in words
    assert "The last step was 0 " not in words


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_velocity_that_is_not_finite_is_named(bad, block):
    run = block()
    run.particles.V[0, 5] = bad
    words = str(failure_of(run, 2))
    assert "not finite" in words or "outside the grid" in words
    assert re.search(r"particle \d+ of body 'block'", words), words


def test_a_position_that_is_not_finite_is_named(block):
    run = block().steps(1)
    run.particles.X[1, 7] = np.nan
    words = str(failure_of(run, 1))
    assert f"particle {run.particles.id[7]} " in words
    assert "body 'block'" in words
    assert "step 2" in words


def test_the_last_good_state_comes_with_the_failure(block):
    run = block(time={"end": 100, "step": 0.05}, bodies__0__velocity=["-x", "0.5*y"])
    run.steps(3)
    run.particles.F[0, 4] = -1.0
    error = failure_of(run, 60)
    good = error.state
    assert good.step % GOOD_EVERY == 0
    assert np.isfinite(good.particles.V).all()
    assert (good.particles.determinant() > 0).all()


GIVES_OUT = "sqrt(0.0042 - t)"
"""An expression that is no number after the time 0.0042, which is within the sixth step."""
HOLD = {"name": "held", "kind": "velocity", "on": {"plane": {"axis": "x", "at": -8}}, "direction": "x"}
WALL = {"name": "held", "kind": "wall", "normal": [1, 0], "position": -2, "velocity": 0, "gradient": 0}
LOAD = {"name": "held", "on": {"body": "block"}}
TOOL = {"name": "held", "material": "tool", "region": {"kind": "box", "lower": [5, 5], "upper": [7, 7]}}
LATER = {
    "gravity": {"loads": [{"name": "held", "kind": "gravity", "acceleration": [0, GIVES_OUT]}]},
    "body force": {"loads": [{**LOAD, "kind": "body_force", "acceleration": [GIVES_OUT, "x"]}]},
    "particle force": {"loads": [{**LOAD, "kind": "particle_force", "force": [GIVES_OUT, 0]}]},
    "traction": {
        "loads": [
            {
                "name": "held",
                "kind": "traction",
                "on": {"body": "block", "face": {"axis": "x", "side": "lower"}},
                "traction": [GIVES_OUT, 0],
            }
        ]
    },
    "velocity": {"boundary": [{**HOLD, "on": {"box": {"lower": [-3, -3], "upper": [0, 0]}}, "value": GIVES_OUT}]},
    "wall position": {"boundary": [{**WALL, "position": f"-2 - {GIVES_OUT}"}]},
    "wall velocity": {"boundary": [{**WALL, "velocity": GIVES_OUT}]},
    "wall gradient": {"boundary": [{**WALL, "gradient": GIVES_OUT}]},
    "rigid body": {
        "bodies__1": {**TOOL, "velocity": [GIVES_OUT, 0]},
        "materials__tool": {"kind": "rigid"},
        "contact": {"law": {"kind": "frictionless"}},
    },
}  # fmt: skip


@pytest.mark.parametrize("update", ["usl", pytest.param("usf", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n in ("rigid body", "traction") else n for n in LATER]
)
def test_an_expression_that_gives_out_during_the_run_shows_the_step_before(name, update, block):
    changes = {key: value for key, value in LATER[name].items() if key != "bodies__1"}
    bodies = [*block().loaded.resolved()["bodies"], LATER[name]["bodies__1"]] if "rigid" in name else None
    changes |= {"bodies": bodies} if bodies else {}
    run = block(time={"end": 1, "step": 0.001}, method__update=update, **changes)
    error = failure_of(run, 10)
    assert re.search(r"(gravity|'held').* is not finite at time 0\.00[45]", str(error)), error
    state = run.simulation.state
    assert error.state.step == state.step > 3
    assert error.state.time == state.time
    np.testing.assert_array_equal(error.state.particles.X, state.particles.X)
    assert error.state.particles.are_possible()


def test_stretching_without_end_is_reported(bar):
    run = bar(boundary=[])
    run.simulation.grid.width = run.simulation.transfer.widest
    run.simulation.transfer.sort()
    run.particles.F[0, 20] = 30.0
    words = str(failure_of(run, 1))
    assert "spans more than" in words
    assert "body 'bar'" in words


@pytest.mark.parametrize("name", ["X", "V", "F", "tau", "mass", "vol0"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_is_found_wherever_it_is(name, bad, block):
    run = block().steps(1)
    getattr(run.particles, name)[..., 11] = bad
    words = str(failure_of(run, 20))
    assert re.search(r"particle \d+ of body 'block'", words), words
    assert re.search(r"step (2|3|4), time", words), words


@pytest.mark.parametrize(
    ("limits", "rate", "words"), [([0.9, 50], -1, "0.9 to 50"), ([0.01, 1.1], 1, "0.01 to 1.1")]
)
def test_volumes_out_of_their_limits_end_the_run(limits, rate, words, block):
    run = block(domain={"volume_ratio": limits}, bodies__0__velocity=[f"{rate}*x", f"{rate}*y"])
    found = str(failure_of(run))
    assert re.match(r"J = [\d.]+ is outside domain\.volume_ratio, " + words, found), found
    assert re.search(PLACE, found), found
    assert "try time.courant" in found


def test_a_particle_that_is_flung_over_more_than_a_cell_ends_the_run(block):
    """The step was chosen before the force that does it."""
    run = block().steps(2)
    run.particles.tau[0, 30] = -1e7
    found = str(failure_of(run, 1))
    assert re.match(r"a particle moved by [\d.e+]+ cells in one step; the fastest is particle \d+", found), (
        found
    )
    assert re.search(PLACE, found), found
    assert "try time.courant" in found


FLIES = {
    "bodies__0__velocity": ["50", "0"],
    "bodies__0__region": {"kind": "box", "lower": [3, -2], "upper": [7, 2]},
}


def test_leaving_the_grid_is_an_error_by_default(block):
    words = str(failure_of(block(**FLIES)))
    assert re.search(PLACE + " left the grid and 15 others", words) or re.search(
        PLACE + " left the grid", words
    )
    assert "domain.on_exit" in words


def test_particles_that_leave_may_be_deleted(block):
    run = block(**FLIES, domain={"on_exit": "delete"})
    mass, count = run.particles.mass.sum(), run.particles.count
    while run.simulation.state.extra["deleted_particles"] == 0:
        run.steps(1)
    gone = 0.0
    while gone != run.simulation.state.extra["deleted_particles"]:
        gone = run.simulation.state.extra["deleted_particles"]
        run.steps(1)
    extra = run.simulation.state.extra
    assert 0 < run.particles.count < count
    assert extra["deleted_particles"] == count - run.particles.count
    assert extra["deleted_mass"] == pytest.approx(mass - run.particles.mass.sum(), rel=1e-12)
    assert len(np.unique(run.particles.id)) == run.particles.count
    assert run.simulation.grid.mp[:, 0].sum() == pytest.approx(run.particles.mass.sum(), rel=1e-12)
    assert run.error < 0.01
    assert "the last particle left the grid" in str(failure_of(run))


@pytest.mark.parametrize(
    "load",
    [{"kind": "traction", "pressure": 1}, {"kind": "traction", "pressure": "x + t"}, {"kind": "absorbing"}],
)
def test_loaded_faces_of_particles_that_are_gone_carry_nothing(block, load):
    """Those of the highest identities are gone first."""
    face = {"body": "block", "face": {"axis": "x", "side": "upper"}}
    run = block(**FLIES, domain={"on_exit": "delete"}, loads=[{"name": "front", "on": face} | load])
    front = run.particles.id[run.particles.X[0] == run.particles.X[0].max()]
    run.steps(1)
    while np.isin(front, run.particles.id).any():
        run.steps(1)
    run.steps(1)
    assert run.particles.count > 0
    assert not run.simulation.loads.force.any()


def test_particles_may_stop_at_the_wall(block):
    run = block(**FLIES, domain={"on_exit": "stop_at_wall"}, time__courant=0.2)
    count = run.particles.count
    for _ in range(20):
        run.steps(1)
        assert run.particles.X[0].max() <= run.simulation.grid.upper[0]
    assert run.particles.count == count
    at_wall = run.particles.X[0] >= run.simulation.grid.upper[0] - 1e-9
    assert at_wall.any()
    assert run.simulation.state.work["boundary_work"] < 0


@pytest.mark.parametrize("update", ["usl+", "usf"])
def test_deleting_works_with_every_work_array(update, block):
    run = block(
        **FLIES, domain={"on_exit": "delete"}, method__update=update, method__damping={"particle": 0.1}
    )
    while run.simulation.state.extra["deleted_particles"] == 0:
        run.steps(1)
    run.steps(3)
    assert np.isfinite(run.particles.V).all()


@pytest.mark.parametrize(("density", "mass"), [(1e90, "inf"), (1e-90, "0")])
def test_masses_beyond_what_numbers_hold_are_refused_at_set_up(density, mass, block):
    with pytest.raises(SceneError, match=rf"bodies\.block\.material +a particle would have mass {mass};"):
        block(
            materials__soft__density=density,
            time={"end": 1, "courant": 0.2, "max_steps": 1},
            analysis={"kind": "plane_strain", "thickness": 1e300 if mass == "inf" else 1e-300},
        )


@pytest.mark.parametrize(("E", "density"), [(1e-300, 1e100), (1e300, 1e-20)])
def test_wave_speeds_that_give_no_step_end_the_run_in_words(E, density, block, monkeypatch):
    monkeypatch.setattr(checks, "MATERIAL_RANGE", (0.0, np.inf))  # which keeps such numbers out of scenes
    soft = {"kind": "neo_hookean", "density": density, "E": E, "nu": 0.3}
    words = str(failure_of(block(materials__soft=soft, bodies__0__velocity=[0, 0]), 1))
    assert words.startswith("the time step is not finite for wave speed")
    assert "units of materials" in words


def test_grids_and_bodies_larger_than_the_memory_are_refused_before_they_are_made(block, monkeypatch):
    monkeypatch.setattr(filling, "available_memory", lambda: 1e9)
    with pytest.raises(
        SceneError, match=r"grid\.cell +a grid of 2\.\d+e\+07 nodes needs 1\.\d+ GB of memory"
    ):
        block(grid={"lower": [-80, -80], "upper": [80, 80], "cell": 1 / 32})
    monkeypatch.setattr(fill, "available_memory", lambda: 1e4)
    with pytest.raises(SceneError, match=r"body 'block' has up to 80 particles, which need 3\.6e-05 GB"):
        block()


# ---------------------------------------------------------------- heat

CONDUCTING = {"kind": "linear_elastic", "density": 1, "E": 1, "nu": 0, "heat_capacity": 1, "conductivity": 1}
SOFT = CONDUCTING | {"E": 1e-3}
WAVY = {
    "bodies__0__temperature": "300 + 100*sin(9*x)",
    "bodies__0__velocity": ["0"],
    "materials__elastic": CONDUCTING,
    "heat": {},
}
"""A bar whose temperature jumps from cell to cell, with D = 1 and cells of length 1."""


def heated(flux):
    face = {"body": "bar", "face": {"axis": "x", "side": "lower"}}
    return {"loads": [{"name": "torch", "kind": "heat_flux", "on": face, "flux": flux}]}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "what", "cure"),
    [
        (
            {"time": {"end": 1e3, "step": 2}, "materials__elastic": SOFT},
            "became -",
            "The last heat step, 2 (Fourier number 2), is probably too long for conduction, or for the power of a "
            "load; try time.step: 1,",
        ),
        (
            {"time": {"end": 1e3, "step": 0.1}, "heat": {"interval": 20}},
            "became -",
            "The last heat step, 2 (Fourier number 2), is probably too long for conduction, or for the power of a "
            "load; try heat.interval: 10,",
        ),
        (
            {"time": {"end": 1e3, "courant": 1}, "heat": {"fourier": 2}, "materials__elastic": SOFT},
            "became -",
            "try heat.fourier: 1,",
        ),
        (
            {"time": {"end": 1e3, "courant": 0.1}, **heated(1e9)},
            "more than twice the highest one before the step",
            "try time.courant: 0.05,",
        ),
        ({"time": {"end": 1e3, "courant": 0.1}, **heated(-1e5)}, "became -", "try time.courant: 0.05,"),
    ],
)
def test_a_heat_step_too_long_ends_with_words(bar, changes, what, cure):
    words = str(failure_of(bar(**{**WAVY, **changes}), 400))
    assert re.search(
        r"the temperature .*; particle \d+ of body 'bar' at \(\S+\), cell \(-?\d+\), in step \d+", words
    )
    assert what in words
    assert cure in words


@pytest.mark.slow
def test_the_failed_temperatures_are_shown(bar):
    run = bar(**{**WAVY, "materials__elastic": SOFT}, time={"end": 1e3, "step": 2}).steps(1)
    good = failure_of(run, 60).state
    assert good.particles.T.shape == (good.particles.count,)
    assert (good.particles.T > 0).all()


@pytest.mark.slow
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_temperature_that_is_not_finite_is_named(bar, bad):
    run = bar(**WAVY).steps(1)
    run.particles.T_carried[5] = bad
    words = str(failure_of(run, 1))
    assert re.search(r"the temperature is not finite; particle \d+ of body 'bar' at \(\S+\), cell", words)


@pytest.mark.slow
def test_a_body_that_cannot_begin_is_not_blamed_on_the_step(bar):
    expands = CONDUCTING | {"expansion": 0.1}
    with pytest.raises(SimulationError, match="check 'expansion', 'T0' and the initial temperature"):
        bar(materials__elastic=expands, bodies__0__temperature="500")


@pytest.mark.parametrize("side", ["lower", "upper"])
def test_stopped_particles_keep_their_heat(side, plain_python):
    """At the upper side a grid line is the lower end of a cell without matter."""
    lower, speed = (1.5, 1.0) if side == "upper" else (0.1, -1.0)
    rock = {
        "kind": "linear_elastic",
        "E": 1,
        "nu": 0,
        "density": 1,
        "heat_capacity": 1,
        "conductivity": 0.1,
        "T0": 300,
    }
    scene = {
        "version": 1,
        "analysis": {"kind": "uniaxial_strain"},
        "grid": {"lower": [0], "upper": [3], "cell": 1},
        "method": {"shape": "linear", "transfer": {"kind": "flip"}},
        "heat": {},
        "materials": {"rock": rock},
        "bodies": [
            {"name": "bar", "material": "rock", "particles_along": "region", "velocity": [speed], "temperature": 300,
             "region": {"kind": "box", "lower": [lower], "upper": [lower + 1.4]}},
        ],
        "domain": {"on_exit": "stop_at_wall"},
        "time": {"end": 10, "step": 0.05},
    }  # fmt: skip
    with plain_python():
        simulation = Simulation(load_scene(yaml.safe_dump(scene)))
        for _ in range(20):
            simulation.step()
    assert simulation.particles.T == pytest.approx(300, rel=1e-12)
