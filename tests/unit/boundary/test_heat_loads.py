"""Heat through faces and from sources against closed forms; totals, and what happens at the edges."""

import math
from types import SimpleNamespace
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from particles_at import particles_at

from mpmcli.boundary.base import LOADS, LoadModel
from mpmcli.boundary.face_heat import FaceHeat
from mpmcli.boundary.film import Film
from mpmcli.boundary.heat_flux import HeatFlux
from mpmcli.boundary.heat_loads import HeatLoads
from mpmcli.boundary.heat_source import HeatSource
from mpmcli.boundary.held_temperatures import HeldTemperatures
from mpmcli.boundary.radiation import Radiation
from mpmcli.boundary.temperature import Temperature
from mpmcli.core.analysis import ANALYSES, F_COMPONENTS
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.step import Step

pytestmark = pytest.mark.usefixtures("python_and_compiled")

KIND = {1: "uniaxial_stress", 2: "plane_strain", 3: "3d"}
KAPPA, INNER, HALF = 3.0, 400.0, 0.25


class Bodies:
    """A block of 2 cells per axis in the middle of a grid of 8, two particles per cell and axis, and its heat loads.

    Its particles see one node each, that below them.
    """

    def __init__(
        self, d, loads=(), held=(), kind=None, section=1.0, fields=1, by_field=False, kappa=KAPPA, **shape
    ):
        self.grid = grid = Grid(np.zeros(d), np.full(d, 8.0), np.ones(d), 2, 2, fields=fields)
        line = 2.0 + (np.arange(4) + 0.5) / 2
        X = np.stack([x.ravel() for x in np.meshgrid(*[line] * d, indexing="ij")])
        self.particles = p = particles_at(ANALYSES[kind or KIND[d]](), X, HALF, 0.5**d, 2.0 * 0.5**d)
        nodes = grid.node_count * (fields if by_field else 1)
        self.theta, self.q = np.full((nodes, 1), INNER), np.zeros((nodes, 1))
        self.field = SimpleNamespace(mp=np.ones((nodes, 2)), nodes=SimpleNamespace(by_field=by_field))
        self.kappa, self.version = kappa, 0
        shape = {"grid_functions": "linear", "domain": "corners"} | shape
        self.loads = HeatLoads(
            held, loads, particles=p, grid=grid, order=self, transfer=self, field=self.field,
            analysis=ANALYSES[kind or KIND[d]](),
            shape=SimpleNamespace(**shape), section=section, bodies=["b"], shown=self.shown,
            conductivity=lambda places, normals: np.full(len(places), self.kappa),
        )  # fmt: skip

    def weights_of(self, places):
        index = np.floor(self.particles.X[:, places] - self.grid.lower[:, None]).astype(int) + self.grid.pad
        strides = np.array([1, *np.cumprod(self.grid.shape[:-1])], dtype=int)
        return (strides @ index)[:, None], np.ones((len(places), 1))

    def add_powers(self, field, power, out):
        nodes, _ = self.weights_of(np.arange(len(power)))
        np.add.at(out[:, 0], nodes[:, 0], power)

    def shown(self, body, face):
        X = self.particles.X[face.index]
        return self.particles.id[(X.max() if face.sign > 0 else X.min()) == X]

    def deform(self, G):
        """Homogeneous deformation x = G X (in-plane axes), the middle where it was."""
        p = self.particles
        d = p.X.shape[0]
        p.X[:] = G @ (p.X - 3.0) + 3.0
        for row, name in enumerate(F_COMPONENTS[d]):
            i, j = "xyz".index(name[0]), "xyz".index(name[1])
            if i < d and j < d:
                p.F[row] = G[i, j]

    def act(self, time=0.0):
        """Total power, and power by name."""
        self.version += 1
        self.q[:] = 0.0
        self.loads.add_to(Step(None, 1.0, time), self.theta, self.q)
        total = float(self.q.sum())
        assert total == pytest.approx(sum(self.loads.powers.values()), rel=1e-12, abs=1e-9)
        return total, self.loads.powers


def place(axis="x", side="upper"):
    return {"body": "b", "face": {"axis": axis, "side": side}}


def held(value, name="hot", axis="x", side="upper"):
    return Temperature(kind="temperature", name=name, on=place(axis, side), value=value)


def film(h, around, name="air", **on):
    return Film(name=name, on=place(**on), coefficient=h, around=around)


def flux(q, name="torch", **on):
    return HeatFlux(name=name, on=place(**on), flux=q)


def radiation(emissivity, around, sigma=5.67e-8, name="sky", **on):
    return Radiation(name=name, on=place(**on), emissivity=emissivity, around=around, stefan_boltzmann=sigma)


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_half_a_particle_conducts_to_a_held_face(d, side):
    for axis in "xyz"[:d]:
        total, powers = Bodies(d, held=[held(300, axis=axis, side=side)], section=3.0).act()
        assert total == pytest.approx(3.0 * 2.0 ** (d - 1) * KAPPA / HALF * (300 - INNER))
        assert powers == {"hot": pytest.approx(total)}


@pytest.mark.parametrize("d", [1, 2, 3])
def test_a_film_is_in_series_with_half_a_particle(d):
    total, _ = Bodies(d, [film(25.0, 500.0)]).act()
    assert total == pytest.approx(2.0 ** (d - 1) * (500.0 - INNER) / (1 / 25.0 + HALF / KAPPA), rel=1e-13)


def test_a_stiff_film_is_a_held_face():
    total, _ = Bodies(2, [film(1e14, 500.0)]).act()
    assert total == pytest.approx(Bodies(2, held=[held(500)]).act()[0], rel=1e-10)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_a_flux_arrives_whole(d):
    bodies = Bodies(d, [flux("7 + t")])
    assert bodies.act(0.0)[0] == pytest.approx(7 * 2.0 ** (d - 1), rel=1e-14)
    assert bodies.act(2.0)[0] == pytest.approx(9 * 2.0 ** (d - 1), rel=1e-14)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([2, 3]), st.sampled_from("xyz"))
def test_area_and_half_size_are_those_of_the_deformed_particle(seed, d, axis):
    """Area J F⁻ᵀ N A₀, and half size along the normal ℓ with 2 ℓ A = J V₀."""
    axis = axis if axis != "z" or d == 3 else "y"
    G = np.eye(d) + np.random.default_rng(seed).uniform(-0.25, 0.25, (d, d))
    bodies = Bodies(d, [flux(2.0, axis=axis)])
    bodies.deform(G)
    normal = np.linalg.det(G) * np.linalg.inv(G).T @ np.eye(d)["xyz".index(axis)]
    assert bodies.act()[0] == pytest.approx(2.0 * 2.0 ** (d - 1) * np.linalg.norm(normal), rel=1e-12)
    loads = bodies.loads
    np.testing.assert_allclose(2 * loads._half * loads._area, np.linalg.det(G) * 0.5**d, rtol=1e-12)
    np.testing.assert_allclose(
        loads._normal, [normal / np.linalg.norm(normal)] * len(loads._half), atol=1e-13
    )
    hot = Bodies(d, held=[held(300, axis=axis)])
    hot.deform(G)
    conductance = KAPPA * (loads._area / loads._half).sum()
    assert hot.act()[0] == pytest.approx(conductance * (300 - INNER), rel=1e-12)


def test_lateral_stretch_widens_a_face():
    bodies = Bodies(1, [flux(2.0)], section=3.0)
    bodies.particles.F[:] = np.array([[1.3], [1.1], [0.9]])
    assert bodies.act()[0] == pytest.approx(6.0 * 0.99)
    assert bodies.loads._half[0] == pytest.approx(HALF * 1.3)
    bodies = Bodies(2, [flux(2.0)], kind="plane_stress")
    bodies.particles.F[4] = 1.1
    assert bodies.act()[0] == pytest.approx(4.0 * 1.1)


def test_axisymmetric_areas_are_per_radian_and_current():
    """r h at r = 4, (r₂² − r₁²)/2 on top."""
    for axis, area in (("x", 4.0 * 2.0), ("y", (16.0 - 4.0) / 2)):
        assert Bodies(2, [flux(2.0, axis=axis)], kind="axisymmetric").act()[0] == pytest.approx(2 * area)
    bodies = Bodies(2, [flux(2.0)], kind="axisymmetric")
    bodies.particles.X[0] += 1.0
    assert bodies.act()[0] == pytest.approx(2 * 5.0 * 2.0)


@pytest.mark.parametrize("around", [4.0, 300.0, 3000.0, 1e6])
@pytest.mark.parametrize("kappa", [1e-6, 3.0, 1e6])
def test_radiation_balances_what_the_particle_conducts(around, kappa):
    bodies = Bodies(2, [radiation(0.8, around)], kappa=kappa)
    power, _ = bodies.act()
    T = brentq(lambda T: kappa / HALF * (T - INNER) - 0.8 * 5.67e-8 * (around**4 - T**4), 0.0, 1e9)
    assert power / 2 == pytest.approx(kappa / HALF * (T - INNER), rel=1e-6)


def brentq(f, low, high):
    for _ in range(300):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if f(middle) > 0.0 else (middle, high)
    return 0.5 * (low + high)


def test_loads_on_one_face_share_its_temperature():
    """Flux, film and radiation: one surface temperature at which all of them sum up to what is conducted."""
    loads = [flux(2000.0), film(30.0, 350.0), radiation(0.5, 900.0)]
    power, powers = Bodies(2, loads).act()
    T = INNER + power / 2 * HALF / KAPPA
    assert T > INNER + 1.0
    assert powers["torch"] == pytest.approx(2 * 2000.0, rel=1e-14)
    assert powers["air"] == pytest.approx(2 * 30.0 * (350.0 - T), rel=1e-9)
    assert powers["sky"] == pytest.approx(2 * 0.5 * 5.67e-8 * (900.0**4 - T**4), rel=1e-9)


def test_the_largest_temperature_that_faces_tend_to():
    for bodies, largest in (
        (Bodies(2, [film(1e9, 350.0)]), 350.0),
        (Bodies(2, held=[held(300), held(500, "y", axis="y")]), 500.0),
        (Bodies(2, [flux(1e9)]), 0.0),
        (Bodies(2, [source(1e9, "total")]), 0.0),
    ):
        bodies.act()
        assert bodies.loads.largest == pytest.approx(largest, rel=1e-5)


def test_a_held_face_takes_what_its_loads_bring():
    power, powers = Bodies(2, [flux(70.0), film(30.0, 350.0)], held=[held(300)]).act()
    assert power == pytest.approx(2 * KAPPA / HALF * (300 - INNER))
    assert powers["torch"] == pytest.approx(140.0)
    assert powers["air"] == pytest.approx(2 * 30.0 * 50.0)
    assert powers["hot"] == pytest.approx(power - 140.0 - 3000.0)


def test_without_conductivity_only_a_flux_heats():
    assert Bodies(2, held=[held(300)], kappa=0.0).act()[0] == 0.0
    assert Bodies(2, [film(25.0, 300.0)], kappa=0.0).act()[0] == pytest.approx(0.0, abs=1e-9)
    assert Bodies(2, [radiation(0.8, 300.0)], kappa=0.0).act()[0] == pytest.approx(0.0, abs=1e-9)
    assert Bodies(2, [flux(7.0)], kappa=0.0).act()[0] == pytest.approx(14.0)


def test_faces_in_part_of_each_other_meet_only_there():
    """The upper faces of x and y have one particle in common, with a face for each."""
    bodies = Bodies(2, [flux(2.0, "a"), flux(3.0, "b", axis="y"), flux(5.0, "c")])
    assert bodies.act()[1] == {name: pytest.approx(2 * q) for name, q in (("a", 2.0), ("b", 3.0), ("c", 5.0))}
    assert len(bodies.loads._faces.id) == 8


def test_two_temperatures_of_a_face_are_an_error():
    assert Bodies(2, held=[held(300), held("300*(1 + 1e-12)", "also")]).act()[1]["also"] == 0.0
    with pytest.raises(SimulationError, match="'also' and one before it contradict each other at time 2"):
        Bodies(2, held=[held(300), held("300 + t", "also")]).act(2.0)


def test_values_are_those_of_the_face_at_the_start():
    bodies = Bodies(2, [flux("x*100 + y")])
    bodies.particles.X += 0.4
    assert bodies.act()[0] == pytest.approx(0.5 * sum(400.0 + y for y in (2.25, 2.75, 3.25, 3.75)))


@pytest.mark.parametrize(
    ("load", "words"),
    [
        (film(25, "300 - 400*t"), r"load 'air': around is -100 at time 1; temperatures are absolute"),
        (film("1 - 2*t", 300), r"load 'air': coefficient is -1 at time 1; must be above 0"),
        (radiation(0.5, "1 - t"), r"load 'sky': around is 0 at time 1; temperatures are absolute"),
        (flux("1/(1 - t)"), r"load 'torch': its value is not finite at time 1"),
    ],
)
def test_values_that_are_not_possible_stop_the_run(load, words):
    with pytest.raises(SimulationError, match=words), np.errstate(divide="ignore"):
        Bodies(2, [load]).act(1.0)


def test_a_held_temperature_below_zero_stops_the_run():
    with pytest.raises(
        SimulationError, match="'hot': its temperature is -1 at time 1; temperatures are absolute"
    ):
        Bodies(2, held=[held("299 - 300*t")]).act(1.0)


@pytest.mark.parametrize(
    ("load", "keys"),
    [
        (film(25, -1.0), ["around"]),
        (film(-1, 300), ["coefficient"]),
        (radiation(0.5, 0), ["around"]),
        (flux(-5), []),
        (flux("z", axis="z"), ["on.face.axis", "flux"]),
        (HeatSource(name="s", on={"body": "b"}, power="z"), ["power"]),
    ],
)
def test_problems_are_listed(load, keys):
    assert [key for key, _ in load.problems(2)] == keys


def test_faces_follow_identities_through_sorting_and_deletion():
    bodies = Bodies(2, [flux("1 + y"), film(25.0, 500.0)])
    bodies.theta[:, 0] = np.random.default_rng(1).uniform(300, 400, len(bodies.theta))
    total, _ = bodies.act()
    q = bodies.q.copy()
    p = bodies.particles
    order = np.random.default_rng(2).permutation(p.count)
    for name in ("X", "F", "size", "id"):
        array = getattr(p, name)
        array[:] = array[..., order]
    assert bodies.act()[0] == pytest.approx(total, rel=1e-13)
    np.testing.assert_allclose(bodies.q, q, atol=1e-11)
    p.keep(p.X[0] < 3.5)  # the faces are gone
    assert bodies.act() == (0.0, {"torch": 0.0, "air": 0.0})


def test_heat_goes_to_the_nodes_of_the_particle_s_field_or_to_those_of_all():
    alone = Bodies(2, [flux(2.0)])
    alone.act()
    own = Bodies(2, [flux(2.0)], fields=2, by_field=True)
    shared = Bodies(2, [flux(2.0)], fields=2)
    for bodies in (own, shared):
        bodies.particles.velocity_field[:] = 1
        bodies.act()
    n = own.grid.node_count
    assert not own.q[:n].any()
    np.testing.assert_array_equal(own.q[n:], alone.q)
    np.testing.assert_array_equal(shared.q, alone.q)
    hot = Bodies(2, held=[held(500)], fields=2, by_field=True)
    hot.particles.velocity_field[:] = 1
    hot.theta[n:] = 500.0  # the temperature is that of the same nodes
    assert hot.act()[0] == 0.0


def test_nodes_without_capacity_get_nothing():
    bodies = Bodies(2, [flux(2.0)])
    bodies.particles.X[0] += 0.1
    x, _ = bodies.grid.coordinates(np.arange(bodies.grid.node_count))
    bodies.field.mp[x > 4.5, 0] = 0.0
    assert bodies.act()[0] == pytest.approx(4.0)
    assert not bodies.q[x > 4.5].any()


def test_a_face_off_the_grid_stops_the_run():
    bodies = Bodies(2, [flux(2.0)])
    bodies.weights_of = lambda places: (np.zeros((len(places), 1), dtype=int), np.ones((len(places), 1)))
    bodies.particles.X[0] += 50.0
    with pytest.raises(SimulationError, match=r"a heated face of particle \d+ left the grid"):
        bodies.act()


def source(power, per, name="s"):
    return HeatSource(name=name, on={"body": "b"}, power=power, per=per)


@pytest.mark.parametrize("kind", ["plane_strain", "axisymmetric"])
def test_sources_are_per_current_volume_mass_or_in_all(kind):
    bodies = Bodies(
        2, [source(3.0, "volume", "v"), source(5.0, "mass", "m"), source("7 + t", "total", "t")], kind=kind
    )
    bodies.deform(np.diag([1.5, 1.2]))
    _, powers = bodies.act(1.0)
    ring = 2 * math.pi if kind == "axisymmetric" else 1.0
    expected = {"v": 3.0 * 4.0 * 1.8, "m": 5.0 * 8.0, "t": 8.0 / ring}
    assert powers == {name: pytest.approx(power) for name, power in expected.items()}
    assert bodies.loads.source_power == pytest.approx(sum(expected.values()))


def test_sources_vary_with_the_place_of_the_particle():
    bodies = Bodies(2, [source("x", "mass")])
    bodies.particles.X += 1.0
    assert bodies.act()[0] == pytest.approx(8.0 * 4.0)


def test_a_total_is_that_of_the_particles_that_are_left():
    bodies = Bodies(2, [source(6.0, "total")])
    bodies.particles.keep(bodies.particles.X[0] < 3.5)
    assert bodies.act()[0] == pytest.approx(6.0)
    bodies.particles.body[:] = 0


class Evaporation(FaceHeat):
    """A law of the surface's temperature that is not ours: heat that grows with the square above a threshold."""

    kind: Literal["evaporation"] = "evaporation"

    def heat_flux_at(self, points, time, temperature):
        above = np.maximum(temperature - 350.0, 0.0)
        return -0.2 * above**2, -0.4 * above


def test_a_plugin_gives_a_flux_by_the_temperature_of_the_surface():
    bodies = Bodies(2, [Evaporation(name="water", on=place())])
    power, _ = bodies.act()
    T = brentq(lambda T: KAPPA / HALF * (T - INNER) + 0.2 * max(T - 350.0, 0.0) ** 2, 300.0, 500.0)
    assert power == pytest.approx(-2 * 0.2 * (T - 350.0) ** 2, rel=1e-9)


def test_a_load_of_heat_needs_an_effect_on_temperature():
    class Cold(LoadModel):
        acts_on = "temperature"
        kind: Literal["cold"] = "cold"

        def acceleration_at(self, points, time):
            return [0.0, 0.0]

    with pytest.raises(TypeError, match="it defines none of heat_flux_at, heat_power_at"):
        LOADS.register(Cold)

    class Faceless(LoadModel):
        acts_on = "temperature"
        kind: Literal["faceless"] = "faceless"

        def heat_flux_at(self, points, time, temperature):
            return 0.0, 0.0

    with pytest.raises(TypeError, match="'heat_flux_at' without 'loaded_face'"):
        LOADS.register(Faceless)


def test_held_temperatures_follow_a_condition_that_moves():
    """A plugin's holder tells by its key that it holds other nodes now."""

    class Moving:
        direction, varies = np.ones(1), False

        def renew(self, active):
            self.active = active

        def key(self, time):
            return int(time)

        def nodes(self, time):
            return self.active[int(time) : int(time) + 1]

        def values(self, time, coordinates):
            return 350.0

    grid = SimpleNamespace(shape=(5,), periodic=(), coordinates=lambda nodes: np.zeros((1, len(nodes))))
    nodes = SimpleNamespace(active=np.arange(5), active_version=1)
    field = SimpleNamespace(nodes=nodes, mp=np.ones((5, 2)))
    model = SimpleNamespace(name="torch", acts_always=True, holder=lambda grid, surface_nodes: Moving())
    held = HeldTemperatures([model], grid, field, None)
    for time, node in ((0.0, 0), (0.5, 0), (2.0, 2)):
        theta = np.full((5, 1), 300.0)
        held.select(time)
        held.impose(theta, counts=True)
        assert np.flatnonzero(theta[:, 0] == 350.0).tolist() == [node]
        assert held.heat.tolist() == [50.0]


@pytest.mark.parametrize(("value", "words"), [(-1.0, "is -1 at"), (0.0, "is 0 at"), (np.nan, "is nan at")])
def test_nodes_held_below_zero_stop_the_run(value, words):
    grid = SimpleNamespace(shape=(5,), periodic=(), coordinates=lambda nodes: np.zeros((1, len(nodes))))
    nodes = SimpleNamespace(active=np.arange(5), active_version=1)
    field = SimpleNamespace(nodes=nodes, mp=np.ones((5, 2)))
    holder = SimpleNamespace(
        renew=lambda active: None,
        key=lambda time: 0,
        nodes=lambda time: np.arange(2),
        values=lambda time, points: 300.0 if time < 1.0 else value,
    )
    model = SimpleNamespace(name="wall", acts_always=True, holder=lambda grid, surface_nodes: holder)
    held = HeldTemperatures([model], grid, field, None)
    held.select(0.5)
    with pytest.raises(SimulationError, match=f"'wall': its temperature {words} time 2; temperatures are"):
        held.select(2.0)


def test_conditions_that_contradict_each_other_at_a_node_stop_the_run():
    """Where they agree, the first one accounts for the node; a node without capacity is nobody's."""

    def condition(name, places, slope):
        holder = SimpleNamespace(
            renew=lambda active: None,
            key=lambda time: 0,
            nodes=lambda time: np.array(places),
            values=lambda time, points: 350.0 + slope * time,
        )
        return SimpleNamespace(name=name, acts_always=True, holder=lambda grid, surface_nodes: holder)

    grid = SimpleNamespace(shape=(5,), periodic=(), coordinates=lambda nodes: 0.5 * np.asarray(nodes)[None])
    nodes = SimpleNamespace(active=np.arange(5), active_version=1)
    field = SimpleNamespace(nodes=nodes, mp=np.ones((5, 2)))
    held = HeldTemperatures(
        [condition("low", [0, 1, 2], 0.0), condition("high", [2, 3], 10.0)], grid, field, None
    )
    held.select(0.0)
    held.impose(np.full((5, 1), 300.0), counts=True)
    assert held.heat.tolist() == [150.0, 50.0]
    words = r"'low' and 'high' contradict each other at time 2: the grid node at \(1\) would .* 350 and 370"
    with pytest.raises(SimulationError, match=words):
        held.select(2.0)
    field.mp[2, 0] = 0.0
    held.select(2.0)
