"""The size of the step: Δt = C Δx_min / max(c, |V|), re-evaluated, or fixed."""

from types import SimpleNamespace

import numpy as np
import pytest

from mpmcli.core.errors import SimulationError
from mpmcli.solver.courant import TimeStep

CASES = {
    "uniaxial_strain": lambda E, nu, rho: E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho,
    "uniaxial_stress": lambda E, nu, rho: E / rho,
    "plane_strain": lambda E, nu, rho: E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho,
    "plane_stress": lambda E, nu, rho: E / (rho * (1 - nu**2)),
    "axisymmetric": lambda E, nu, rho: E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho,
    "3d": lambda E, nu, rho: E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho,
}


@pytest.mark.parametrize("kind", CASES)
def test_the_first_step_follows_the_wave_speed_of_the_analysis(kind, block):
    E, nu, rho, C, cell = 70.0, 0.3, 2.0, 0.3, (0.5, 1.0, 2.0)
    d = {"uniaxial_strain": 1, "uniaxial_stress": 1, "3d": 3}.get(kind, 2)
    run = block(
        analysis={"kind": kind},
        grid={"lower": [0.0] * d, "upper": [4.0] * d, "cell": list(cell[:d])},
        materials={"soft": {"kind": "linear_elastic", "density": rho, "E": E, "nu": nu}},
        bodies=[
            {
                "name": "b",
                "material": "soft",
                "region": {"kind": "box", "lower": [0.0] * d, "upper": [2.0] * d},
            }
        ],
        time={"end": 1, "courant": C},
    )
    s = run.simulation
    assert s.wave_speed == pytest.approx(np.sqrt(CASES[kind](E, nu, rho)), rel=1e-12)
    assert s.time_step.choose(s.wave_speed, s.particle_speed) == pytest.approx(
        C * 0.5 / s.wave_speed, rel=1e-12
    )


def test_fast_particles_shorten_the_step(block):
    run = block(bodies__0__velocity=["300", "-400"], grid={"lower": [-8, -8], "upper": [8, 8], "cell": 1})
    run.simulation.step()
    assert run.simulation.state.dt == pytest.approx(0.2 / 500, rel=1e-12)


def test_the_wave_speed_follows_the_state(block):
    """Waves run faster along a stretched neo-Hookean block: steps become shorter."""
    run = block(bodies__0__velocity=["4*x", "0"], time__courant=0.1)
    first = run.simulation.wave_speed
    run.until(0.08)
    assert run.simulation.wave_speed > 1.02 * first
    assert run.simulation.state.dt < 0.1 / first


def test_no_courant_number_lets_a_particle_cross_more_than_a_cell():
    step = TimeStep(None, 1.25, smallest_cell=2.0)
    assert step.choose(10.0, 4.0) == 0.25
    assert step.choose(10.0, 9.0) == pytest.approx(2.0 / 9.0)
    assert step.choose(10.0, 40.0) == 0.05


def test_a_fixed_step_stays(block):
    run = block(time={"end": 1, "step": 0.004}).steps(3)
    assert run.simulation.state.dt == 0.004
    assert run.simulation.time == pytest.approx(0.012, rel=1e-14)


def span(**values):
    return SimpleNamespace(**({"step": None, "courant": None} | values))


def test_a_collapsed_step_is_an_error_in_words():
    step = TimeStep(None, 0.5, smallest_cell=2.0)
    assert step.choose(10.0, 4.0) == 0.1
    assert step.choose(10.0, 40.0) == 0.025
    with pytest.raises(SimulationError, match=r"time step decreased from 0\.1 to 1e-0?8: .* unstable"):
        step.choose(1e8, 0.0)


@pytest.mark.parametrize("speed", [np.inf, np.nan])
def test_speeds_that_are_not_finite_collapse_the_step(speed):
    step = TimeStep(None, 0.5, smallest_cell=2.0)
    step.choose(10.0, 0.0)
    with pytest.raises(SimulationError):
        step.choose(speed, 0.0)


def test_courant_number_of_a_step():
    step = TimeStep(0.1, None, smallest_cell=0.5)
    assert step.choose(3.0, 4.0) == step.dt == 0.1
    assert step.courant_of_step == pytest.approx(0.8)


def test_a_particle_faster_than_a_cell_per_step_is_refused_by_name(block):
    run = block(time={"end": 1, "step": 0.004})
    run.particles.V[0, 3] = 251.0
    run.simulation.particle_speed = 251.0
    identity = run.particles.id[3]
    before = run.particles.X.copy()
    with pytest.raises(SimulationError, match=r"would move by 1 cells in one step of 0\.004") as caught:
        run.simulation.step()
    assert f"the fastest is particle {identity} of body 'block' at (" in str(caught.value)
    assert "with speed 251" in str(caught.value)
    assert "try time.step below" in str(caught.value)
    assert caught.value.state.step == 0
    np.testing.assert_array_equal(run.particles.X, before)


def test_a_collapsed_step_names_what_controls_it(block):
    run = block().steps(1)
    run.simulation.stress.wave_speed = 1e12
    run.particles.F[0, 7] = 0.01
    identity = run.particles.id[7]
    with pytest.raises(SimulationError, match=rf"the most compressed is particle {identity} of body 'block'"):
        run.simulation.step()
