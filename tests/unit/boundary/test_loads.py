"""Gravity, body forces and particle forces."""

import math
from typing import Literal

import numpy as np
import pytest
from particles_at import particles_at
from pydantic import ValidationError

from mpmcli.boundary import CONDITIONS, LOADS, ConditionModel, LoadModel
from mpmcli.boundary.body_force import BodyForce
from mpmcli.boundary.buoyancy import Buoyancy
from mpmcli.boundary.gravity import Gravity
from mpmcli.boundary.particle_force import ParticleForce
from mpmcli.boundary.particle_loads import ParticleLoads
from mpmcli.boundary.traction import Traction
from mpmcli.core.analysis import Axisymmetric, PlaneStrain
from mpmcli.core.errors import SimulationError
from mpmcli.core.particles import Particles


def particles(count=10, seed=0):
    rng = np.random.default_rng(seed)
    X, mass = rng.uniform(0, 4, (2, count)), rng.uniform(1, 2, count)
    return particles_at(PlaneStrain(), X, 0.25, mass=mass, owner=np.arange(count) % 2)


def loads(*models, analysis=PlaneStrain(), p=None):
    return ParticleLoads(models, analysis, ["left", "right"], particles() if p is None else p)


def test_gravity_adds_up_and_may_vary_in_time():
    made = loads(
        Gravity(name="a", acceleration=[0, "-9.81*ramp(t, 0, 2)"]), Gravity(name="b", acceleration=[1, 0])
    )
    np.testing.assert_allclose(made.gravity(1.0), [1.0, -4.905])
    assert loads().gravity(0.0) is None
    assert made.accelerations(0.0, particles()) is None


def test_gravity_may_come_with_the_particles():
    p = particles()
    made = loads(Gravity(name="a", acceleration=[0, -2]), p=p)
    B = made.accelerations(0.0, p, with_gravity=True)
    np.testing.assert_array_equal(B, np.array([[0.0], [-2.0]]) * np.ones(p.count))


def test_body_forces_are_evaluated_where_particles_are():
    p = particles()
    made = loads(
        BodyForce(name="a", acceleration=["x*t", "1 + y"]),
        BodyForce(name="b", on={"body": "right"}, acceleration=[1, "x"]),
        p=p,
    )
    for time in (0.0, 2.0):
        x, y = p.X
        right = p.body == 1
        expected = [x * time + right, 1 + y + x * right]
        np.testing.assert_allclose(made.accelerations(time, p), expected)
        p.X += 0.5


def test_initial_coordinates_stay_with_the_particle():
    p = particles()
    start = p.X.copy()
    made = loads(BodyForce(name="a", acceleration=["x", "y*t"], coordinates="initial"), p=p)
    order = np.random.default_rng(1).permutation(p.count)
    p.X[:] = p.X[:, order] + 1.0
    p.id[:] = order
    np.testing.assert_allclose(made.accelerations(3.0, p), [start[0, order], 3 * start[1, order]])


def test_initial_positions_are_kept_only_where_needed():
    p = particles()
    made = loads(BodyForce(name="a", acceleration=["x", "y"]), p=p)
    assert made.initial_positions is None
    chosen = ParticleForce(name="a", on={"box": {"lower": [0, 0], "upper": [2, 4]}}, force=[3, -1])
    assert loads(chosen, p=p).initial_positions is None


def test_water_lifts_what_is_below_its_table():
    """By ρ_w g per current volume; in proportion to the part of the domain that is below."""
    p = particles()
    p.X[1] = np.linspace(0, 4, p.count)
    p.F[0] = 1.2
    weight = Gravity(name="a", acceleration=[0, "-3*t"])
    made = loads(Buoyancy(name="b", on={"body": "left"}, level="2+t/4+0*x", density=0.5), weight, p=p)
    below = np.clip(0.5 + (2.5 - p.X[1]) / 0.5, 0, 1)
    expected = 0.5 * 6 * 1.2 * p.vol0 / p.mass * below * (p.body == 0)
    np.testing.assert_allclose(made.accelerations(2.0, p), [0 * expected, expected])
    np.testing.assert_allclose(made.accelerations(2.0, p, with_gravity=True), [0 * expected, expected - 6])
    assert ((below > 0) & (below < 1)).any()
    assert not made.accelerations(0.0, p).any()


def test_a_total_force_is_shared_by_mass():
    p = particles()
    made = loads(ParticleForce(name="a", on={"body": "left"}, force=["3*t", -1]), p=p)
    B = made.accelerations(2.0, p)
    np.testing.assert_allclose(B @ p.mass, [6.0, -1.0])
    left = p.body == 0
    assert np.ptp(B[0, left]) < 1e-14
    np.testing.assert_array_equal(B[:, ~left], 0.0)


def test_a_force_per_particle_is_the_same_on_each():
    p = particles()
    made = loads(
        ParticleForce(
            name="a", on={"box": {"lower": [0, 0], "upper": [2, 4]}}, force=[3, -1], per="particle"
        ),
        p=p,
    )
    inside = p.X[0] <= 2
    p.X += 5.0
    force = made.accelerations(0.0, p) * p.mass
    np.testing.assert_allclose(force, np.array([[3.0], [-1.0]]) * inside)


def test_a_region_and_a_body_choose_what_is_in_both():
    class Right:
        def contains(self, points):
            return points[0] > 2

    p = particles(40)
    made = loads(ParticleForce(name="a", on={"body": "left", "region": Right()}, force=[3, 0]), p=p)
    B = made.accelerations(0.0, p)
    np.testing.assert_array_equal(B[0] > 0, (p.X[0] > 2) & (p.body == 0))
    assert B[0] @ p.mass == pytest.approx(3.0)


def test_the_total_does_not_change_when_particles_are_lost():
    p = particles()
    made = loads(ParticleForce(name="a", on={"body": "left"}, force=[3, 0]), p=p)
    kept = Particles(**{name: array[..., 3:] for name, array in p.arrays().items()})
    assert made.accelerations(0.0, kept)[0] @ kept.mass == pytest.approx(3.0)
    none = Particles(**{name: array[..., p.body == 1] for name, array in p.arrays().items()})
    np.testing.assert_array_equal(made.accelerations(0.0, none), 0.0)


def test_a_force_per_particle_may_depend_on_where_it_is_now():
    p = particles()
    force = ParticleForce(name="a", on={"body": "left"}, force=["3*x + t", "y"], per="particle")
    assert force.varies
    made = loads(force, p=p)
    for _ in range(2):
        left = p.body == 0
        found = (made.accelerations(2.0, p, version=1) * p.mass)[:, left]
        np.testing.assert_allclose(found, [3 * p.X[0, left] + 2, p.X[1, left]])
        p.X += 1.0
    total = ParticleForce(name="a", on={"body": "left"}, force=["x", 0])
    assert [key for key, _ in total.problems(2)] == ["force.0"]


def test_forces_of_the_user_are_those_on_the_full_ring():
    p = particles()
    made = loads(ParticleForce(name="a", on={"body": "left"}, force=[0, 3]), analysis=Axisymmetric(), p=p)
    assert made.accelerations(0.0, p)[1] @ p.mass * 2 * math.pi == pytest.approx(3.0)


def test_loads_that_never_change_are_kept_between_sorts():
    p = particles()
    made = loads(BodyForce(name="a", acceleration=["x", 0], coordinates="initial"), p=p)
    first = made.accelerations(0.0, p, version=1).copy()
    p.id[:] = p.id[::-1].copy()
    np.testing.assert_array_equal(made.accelerations(1.0, p, version=1), first)
    np.testing.assert_array_equal(made.accelerations(1.0, p, version=2), first[:, ::-1])


def test_values_that_are_not_finite_stop_the_run():
    p = particles()
    made = loads(BodyForce(name="spin", acceleration=["log(x - 9)", 0]), p=p)
    with pytest.raises(SimulationError, match="load 'spin': its value is not finite at time 1"):
        made.accelerations(1.0, p)
    with pytest.raises(SimulationError, match="load 'a': its value is not finite"):
        loads(Gravity(name="a", acceleration=["1/t", 0])).gravity(0.0)


def test_tractions_act_on_faces():
    on = {"body": "left", "face": {"axis": "x", "side": "upper"}}
    traction = Traction(name="t", on=on, pressure=1)
    assert traction.effects() == {"traction_at"}
    assert traction.loaded_face() == ("left", traction.on.face)
    assert traction.traction_at(np.zeros((2, 3)), 0.0) == [-1.0, 0.0]
    assert loads(traction).accelerations(0.0, particles(), with_gravity=True) is None
    assert traction.bodies() == [("on.body", "left")]
    assert traction.follows
    assert not Traction(name="t", on=on, pressure=1, follower=False).follows
    assert not Traction(name="t", on=on, traction=[1, 0]).follows
    with pytest.raises(ValidationError, match="give either traction or pressure"):
        Traction(name="t", on=on)
    with pytest.raises(ValidationError, match="give either traction or pressure"):
        Traction(name="t", on=on, traction=[1, 0], pressure=1)


@pytest.mark.parametrize(
    ("model", "keys"),
    [
        (Gravity(name="a", acceleration=[0]), ["acceleration"]),
        (BodyForce(name="a", acceleration=["z", 0]), ["acceleration.0"]),
        (BodyForce(name="a", acceleration=[0, 0]), []),
        (ParticleForce(name="a", on={"body": "b"}, force=[1]), ["force"]),
        (
            ParticleForce(name="a", on={"box": {"lower": [1], "upper": [0, 1]}}, force=[1, 1]),
            ["on.box.lower"],
        ),
        (
            Traction(name="t", on={"body": "b", "face": {"axis": "z", "side": "lower"}}, traction=[1]),
            ["on.face.axis", "traction"],
        ),
        (
            Traction(name="t", on={"body": "b", "face": {"axis": "x", "side": "lower"}}, pressure="z"),
            ["pressure"],
        ),
    ],
)
def test_what_does_not_fit_the_axes_is_listed(model, keys):
    assert [key for key, _ in model.problems(2)] == keys


def test_all_kinds_are_registered():
    heat = {"film", "heat_flux", "heat_source", "radiation"}
    assert set(LOADS) == heat | {
        *("absorbing", "body_force", "buoyancy", "gravity", "nodal_force", "particle_force", "traction")
    }
    assert {kind for kind in LOADS if LOADS[kind].acts_on == "temperature"} == heat


def test_a_target_must_be_said():
    with pytest.raises(ValidationError, match="give body, box or region"):
        ParticleForce(name="a", on={}, force=[1])


class Lift(LoadModel):
    """Two effects in one kind: an acceleration of all, and a force on the upper half."""

    kind: Literal["lift"] = "lift"

    def uniform_acceleration(self, time):
        return [0.0, 2.0 * time]

    def chosen(self, points, is_of):
        return is_of("left") & (points[1] > 2.0)

    def force_at(self, points, time):
        return [points[0], 0.0]

    def problems(self, dimensions):
        return []


def test_a_load_acts_by_the_methods_that_it_has():
    p = particles()
    made = loads(Lift(name="up"), p=p)
    np.testing.assert_array_equal(made.gravity(3.0), [0.0, 6.0])
    chosen = (p.body == 0) & (p.X[1] > 2.0)
    assert 0 < chosen.sum() < 10
    p.X += 1.0
    B = made.accelerations(1.0, p)
    np.testing.assert_allclose(B * p.mass, [np.where(chosen, p.X[0], 0.0), np.zeros(10)])


def test_a_load_without_effect_is_refused():
    class Idle(LoadModel):
        kind: Literal["idle"] = "idle"

    with pytest.raises(TypeError, match="Idle is not a load: it defines none of uniform_acceleration"):
        LOADS.register(Idle)
    assert "idle" not in LOADS

    class Faceless(Idle):
        def traction_at(self, points, time):
            return [0.0, 0.0]

    with pytest.raises(TypeError, match="'traction_at' without 'loaded_face'"):
        LOADS.register(Faceless)


def test_a_condition_that_holds_nothing_is_refused():
    class Idle(ConditionModel):
        kind: Literal["idle"] = "idle"

    with pytest.raises(TypeError, match="Idle is not a boundary condition: it does not define 'holder'"):
        CONDITIONS.register(Idle)
    assert "idle" not in CONDITIONS


@pytest.mark.parametrize("kind", list(LOADS))
def test_our_loads_say_what_they_do(kind):
    assert LOADS[kind].effects()
