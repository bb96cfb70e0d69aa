"""What every transport quantity is held to, with all shape functions, analyses and transfers.

Loops run as Python: a few particles take a few steps.
"""

import itertools
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmcli.core.analysis import ANALYSES
from mpmcli.scene.loader import load_scene
from mpmcli.scene.method import UPDATES
from mpmcli.shapes import SHAPES
from mpmcli.solver.simulation import Simulation

DIMENSIONS = {name: analysis().dimensions for name, analysis in ANALYSES.items()}
TRANSFERS = {
    "flip": {"kind": "flip"},
    "flip3": {"kind": "flip", "order": 3},
    "pic": {"kind": "fmpm", "order": 1},
    "fmpm4": {"kind": "fmpm", "order": 4},
    "seldom": {"kind": "fmpm", "order": 3, "every_steps": 2},
}
HEAVY = ("lcpdi", "qcpdi", "b2gimp", "b2cpdi")
"""Shape functions with many nodes in 3D."""


def mark(shape: str, analysis: str) -> list:
    return [pytest.mark.slow] if analysis == "3d" and shape in HEAVY else []


ALL = [
    pytest.param(shape, analysis, transfer, id=f"{shape}-{analysis}-{transfer}", marks=mark(shape, analysis))
    for (shape, analysis), transfer in zip(
        itertools.product(SHAPES, ANALYSES), itertools.cycle(TRANSFERS), strict=False
    )
]
"""Every shape function in every analysis; the transfers take turns."""


def scene_of(shape: str, analysis: str, transfer: str, **keys: Any) -> dict:
    """A block off the grid lines that conducts."""
    d = DIMENSIONS[analysis]
    return {
        "version": 1,
        "analysis": {"kind": analysis},
        "grid": {
            "lower": [0 if analysis == "axisymmetric" and a == 0 else -4 for a in range(d)],
            "upper": [6] * d,
            "cell": 1,
        },
        "method": {"shape": shape, "transfer": {"kind": "flip"}},
        "heat": {"transfer": TRANSFERS[transfer]},
        "materials": {
            "m": {
                "kind": "linear_elastic", "density": 1.3, "E": 4, "nu": 0.3, "heat_capacity": 2.1, "conductivity": 0.3,
            }
        },
        "bodies": [
            {"name": "b", "material": "m", "region": {"kind": "box", "lower": [0.3] * d, "upper": [1.8] * d}}
        ],
        "time": {"end": 10, "step": 0.1},
    } | keys  # fmt: skip


def simulation(scene: dict) -> Simulation:
    return Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)


def put(s: Simulation, T: np.ndarray | float) -> None:
    """Give temperatures to the particles."""
    carried(s)[...] = T
    s.particles.T[...] = T
    s.heat.begin()


def carried(s: Simulation) -> np.ndarray:
    """The temperature that goes to the grid."""
    return s.particles.T if s.particles.T_carried is None else s.particles.T_carried


def stir(s: Simulation, seed: int = 3) -> np.random.Generator:
    """Velocities that strain and turn the block, and particles that lie on no lattice."""
    rng = np.random.default_rng(seed)
    p = s.particles
    p.X += rng.uniform(-0.1, 0.1, p.X.shape)
    p.V[...] = rng.uniform(-0.3, 0.3, p.V.shape)
    return rng


def steps(s: Simulation, count: int = 2) -> Simulation:
    for _ in range(count):
        s.step()
    return s


@pytest.mark.parametrize(("shape", "analysis", "transfer"), ALL)
def test_heat_is_conserved_and_a_constant_stays(plain_python, shape, analysis, transfer):
    with plain_python():
        s = simulation(scene_of(shape, analysis, transfer))
        put(s, 321.7)
        stir(s)
        steps(s)
        assert np.abs(s.particles.T / 321.7 - 1).max() < 1e-14 * 30
        assert np.abs(carried(s) / 321.7 - 1).max() < 1e-14 * 30
        s = simulation(scene_of(shape, analysis, transfer))
        put(s, stir(s).uniform(200, 400, s.particles.count))
        p = s.particles
        before, first = float(p.mass @ carried(s)), carried(s).copy()
        steps(s)
        assert abs(float(s.particles.mass @ carried(s)) / before - 1) < 1e-13
        assert np.abs(carried(s) - first).max() > 1e-3
        # what is seen is a mean of what is on the grid; it holds the same heat
        assert abs(float(s.particles.mass @ s.particles.T) / before - 1) < 1e-13


@pytest.mark.parametrize("heating", ["isothermal", "adiabatic"])
@pytest.mark.parametrize("transfer", TRANSFERS)
def test_particles_and_nodes_carry_little_more(plain_python, transfer, heating):
    """At most 40 bytes per particle, 32 per node, and 8 more where there is a loop."""
    method = {"shape": "ugimp", "transfer": {"kind": "flip"}, "heating": heating}
    solid = {"kind": "neo_hookean", "density": 1.3, "E": 4, "nu": 0.3}
    warm = solid | {"expansion": 1e-5, "heat_capacity": 2.1, "conductivity": 0.3}
    with plain_python():
        s = simulation(scene_of("ugimp", "3d", transfer, method=method, materials={"m": warm}))
        plain = scene_of("ugimp", "3d", transfer, materials={"m": solid})
        del plain["heat"]
        bare = simulation(plain)
    held, few = (sum(a.nbytes for a in each.particles.arrays().values()) for each in (s, bare))
    assert few < held <= few + 40 * s.particles.count - s.heat.capacity().nbytes
    nodal = sum(a.nbytes for a in s.heat.nodal_arrays().values())
    assert nodal == (32 + 8 * (s.heat.choices.order > 1)) * len(s.heat.nodal.v)


MOTIONS: dict[str, dict[str, Any]] = {
    "flip": {"kind": "flip"},
    "gradient": {"kind": "flip", "velocity_gradient": True},
    "xpic": {"kind": "xpic", "order": 2},
    "fmpm": {"kind": "fmpm", "order": 3, "velocity_gradient": True},
    "periodic": {"kind": "fmpm", "order": 3, "every_steps": 2},
    "blend": {"kind": "fmpm", "order": 3, "blend": {"order": 2, "fraction": 0.8}},
    "dynamic": {"kind": "fmpm", "order": 6, "dynamic": {"metric": "means", "tolerance": 0.1}},
}
"""Transfers of velocities."""


@pytest.mark.parametrize(
    ("update", "motion"),
    [
        pytest.param(update, motion, marks=[] if i == j % len(UPDATES) else pytest.mark.slow)
        for i, update in enumerate(UPDATES)
        for j, motion in enumerate(MOTIONS)
    ],
)
def test_heat_does_not_depend_on_how_velocities_go(plain_python, update, motion):
    """Heat is conserved with every strain update and transfer of velocities; at rest temperatures are the same."""
    transfer = list(TRANSFERS)[(list(UPDATES).index(update) + list(MOTIONS).index(motion)) % len(TRANSFERS)]
    method = {"shape": "ugimp", "update": update, "transfer": MOTIONS[motion], "heating": "isothermal"}
    found = []
    with plain_python():
        for keys in ({}, {"method": method}):
            s = simulation(scene_of("ugimp", "plane_strain", transfer, **keys))
            put(s, 300 + 50 * np.sin(np.arange(s.particles.count)))
            found.append(steps(s).particles.T.copy())
        stir(s)
        before = float(s.particles.mass @ carried(s))
        steps(s)
    assert np.abs(found[1] / found[0] - 1).max() < 1e-14
    assert np.ptp(found[0]) > 1.0
    assert abs(float(s.particles.mass @ carried(s)) / before - 1) < 1e-13


@settings(max_examples=15)
@given(
    st.lists(st.floats(1e3, 1e4), min_size=9, max_size=9),
    st.lists(st.floats(-0.2, 0.2), min_size=18, max_size=18),
    st.sampled_from(sorted(TRANSFERS)),
    st.sampled_from(["linear", "ugimp", "bspline2"]),
)
def test_heat_of_any_temperatures_at_any_places_is_conserved(plain_python, T, off, transfer, shape):
    """Not below a tenth of the largest: FMPM(4) swings beyond the others by a twentieth of a difference."""
    with plain_python():
        s = simulation(scene_of(shape, "plane_strain", transfer))
        assert s.particles.count == 9
        s.particles.X += np.array(off).reshape(2, 9)
        put(s, np.array(T))
        before = float(s.particles.mass @ carried(s))
        steps(s)
        assert abs(float(s.particles.mass @ carried(s)) / before - 1) < 1e-13


@pytest.mark.parametrize(
    ("shape", "analysis"),
    [pytest.param(s, a, marks=[pytest.mark.slow] * (a == "3d")) for s in SHAPES for a in ANALYSES],
)
def test_a_linear_field_has_its_exact_gradient(plain_python, shape, analysis):
    """Inside a regular lattice the nodes see the field itself; in axisymmetric analyses along z."""
    d = DIMENSIONS[analysis]
    scene = scene_of(shape, analysis, "flip", archive={"particles": {"every": 1, "fields": ["heat_flux"]}})
    cells = 9 if shape.startswith("b2") else 7  # as many as reach the one in the middle, through nodes
    scene["bodies"][0] |= {"particles_per_axis": 1}
    scene["bodies"][0]["region"] |= {"lower": [0.0] * d, "upper": [float(cells)] * d}
    scene["grid"]["upper"] = [cells + 3.0] * d
    with plain_python():
        s = simulation(scene)
        w = np.array([7.0, -5.0, 3.0])[:d]
        if analysis == "axisymmetric":
            w[0] = 0.0
        put(s, 400 + w @ s.particles.X)
        steps(s, 1)
        p = s.particles
        inside = np.abs(p.X - cells / 2).max(axis=0) < 0.1
        assert inside.sum() == 1
        assert np.abs(p.heat_flux[:, inside] + 0.3 * w[:, None]).max() < 1e-12


@pytest.mark.parametrize("transfer", TRANSFERS)
@pytest.mark.parametrize("analysis", ANALYSES)
def test_the_order_of_particles_changes_only_round_off(plain_python, analysis, transfer):
    found = []
    with plain_python():
        for reverse in (False, True):
            s = simulation(scene_of("ugimp", analysis, transfer))
            p = s.particles
            T = 300 + 50 * np.sin(np.arange(p.count))
            put(s, T)
            if reverse:
                for name, array in p.arrays().items():
                    setattr(p, name, np.ascontiguousarray(array[..., ::-1]))
                s.order.version += 1
            steps(s)
            out = np.empty(p.count)
            out[s.particles.id] = s.particles.T
            found.append(out)
    assert np.abs(found[0] / found[1] - 1).max() < 1e-13


TURNS = {
    1: [np.array([[-1]])],
    2: [np.diag([-1, 1]), np.array([[0, -1], [1, 0]]), np.array([[0, 1], [1, 0]])],
    3: [
        np.diag([1, -1, 1]),
        np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]),
        np.array([[0, -1, 0], [1, 0, 0], [0, 0, -1]]),
    ],
}
"""Mirrors, quarter turns and what they make together."""


@pytest.mark.parametrize("transfer", TRANSFERS)
@pytest.mark.parametrize(
    ("shape", "analysis"),
    [
        pytest.param(shape, analysis, marks=mark(shape, analysis))
        for shape in ("ugimp", "lcpdi", "b2gimp")
        for analysis in ("uniaxial_strain", "plane_strain", "3d")
    ],
)
def test_mirror_images_and_quarter_turns_change_only_round_off(plain_python, analysis, shape, transfer):
    d = DIMENSIONS[analysis]

    def state(R):
        scene = scene_of(shape, analysis, transfer)
        scene["grid"] |= {"lower": [-5] * d, "upper": [5] * d}
        corners = R @ np.array([[0.3, 1.8], [-1.2, 0.3], [0.45, 1.45]])[:d]
        region = scene["bodies"][0]["region"]
        region["lower"], region["upper"] = corners.min(axis=1).tolist(), corners.max(axis=1).tolist()
        s = simulation(scene)
        p = s.particles
        Y = R.T @ p.X
        w = np.array([1.0, 0.7, -0.4])[:d]
        p.V[...] = R @ (0.2 * np.sin(np.multiply.outer(w, w @ Y)))
        put(s, 300 + 60 * np.sin(2 * w @ Y) + 30 * Y[0])
        steps(s)
        Y = R.T @ s.particles.X
        order = np.lexsort(np.round(Y, 7))
        return s.particles.T[order], carried(s)[order]

    with plain_python():
        first = state(np.eye(d))
        assert np.ptp(first[0]) > 3
        for R in TURNS[d]:
            for one, other in zip(first, state(R.astype(float)), strict=True):
                assert np.abs(one / other - 1).max() < 1e-12
