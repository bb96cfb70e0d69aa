"""A small state, and a scene that asks for output, without a solver."""

from types import SimpleNamespace

import numpy as np
import pytest

from mpmcli.core.analysis import ANALYSES, F_COMPONENTS
from mpmcli.core.particles import Particles
from mpmcli.core.state import GridView, State
from mpmcli.scene.archive import Archive
from mpmcli.scene.method import Damping


@pytest.fixture
def make_state():
    """Makes a state with deformed, moving, stressed particles, not in the order of their identities."""

    def make(kind: str = "plane_strain", count: int = 6, seed: int = 1, **changes) -> State:
        random = np.random.default_rng(seed)
        analysis = ANALYSES[kind]()
        d = analysis.dimensions
        particles = Particles.at_rest(
            analysis,
            X=random.uniform(0.5, 3.5, (d, count)),
            size=np.full((d, count), 0.25),
            vol0=random.uniform(0.5, 1.5, count),
            mass=random.uniform(1.0, 2.0, count),
            body=np.arange(count) % 2,
            material=np.arange(count) // 3 % 2,
            velocity_field=np.zeros(count),
            history_rows=2,
        )
        particles.V[:] = random.normal(size=(d, count))
        particles.F[:] += 0.1 * random.normal(size=(len(F_COMPONENTS[d]), count))
        particles.tau[:] = random.normal(size=particles.tau.shape)
        particles.L[:] = random.normal(size=particles.L.shape)
        particles.H[:] = random.uniform(1.0, 2.0, (2, count))
        particles.stress_work[:] = random.uniform(size=count)
        particles.id[:] = random.permutation(count)
        models = [SimpleNamespace(history=()), SimpleNamespace(history=("plastic_work", "temperature"))]
        state = State(
            analysis=analysis,
            particles=particles,
            bodies=["left", "right"],
            materials=["rubber", "steel"],
            material_models=models,
            strain_energy_density=lambda: np.full(particles.count, 2.0),
            full_ring=2.0 * np.pi if kind == "axisymmetric" else 1.0,
            work={"boundary_work": 0.5, "external_work": 0.25, "damping_work": 0.125},
            reactions={"base": np.arange(1.0, d + 1.0)},
            X0=random.uniform(0.5, 3.5, (d, count)),
        )
        for name, value in changes.items():
            setattr(state, name, value)
        return state

    return make


@pytest.fixture
def make_grid():
    """Makes a grid view of 5 × 4 (× 3) nodes with a linear velocity field and mass everywhere."""

    def make(d: int = 2) -> GridView:
        nodes, lower = (5, 4, 3)[:d], np.array([0.0, 1.0, 2.0])[:d]
        cell = np.array([1.0, 0.5, 2.0])[:d]
        axes = [lower[a] + cell[a] * np.arange(nodes[a]) for a in range(d)]
        places = np.stack([p.ravel(order="F") for p in np.meshgrid(*axes, indexing="ij")], axis=1)
        slope = np.arange(1.0, d * d + 1.0).reshape(d, d)
        fields = {"mass": lambda: np.ones(len(places)), "velocity": lambda: places @ slope.T + 1.0}
        return GridView(lower=lower, cell=cell, nodes=nodes, fields=fields)

    return make


class Labels:
    """Units whose labels are the dimensions in brackets."""

    def label(self, dimension: str) -> str:
        return f"[{dimension}]"


@pytest.fixture
def make_loaded(tmp_path):
    """Makes what the loader returns, with an archive and probes of choice."""

    def make(archive: dict | None = None, probes: tuple = (), kind: str = "plane_strain") -> SimpleNamespace:
        if archive is None:
            archive = {"particles": {"every": 0.5}, "globals": {"every": 0.25}}
        history = ("plastic_work", "temperature")
        scene = SimpleNamespace(
            title="A test",
            analysis=SimpleNamespace(kind=kind),
            materials={
                "rubber": SimpleNamespace(kind="neo_hookean", history=()),
                "steel": SimpleNamespace(kind="j2_plastic", history=history),
            },
            bodies=[
                SimpleNamespace(name="left", material="rubber"),
                SimpleNamespace(name="right", material="steel"),
            ],
            contact=None,
            cracks=(),
            fracture=None,
            heat=None,
            has_temperature=False,
            conditions_on=lambda quantity: [SimpleNamespace(name="base")] * (quantity == "velocity"),
            loads_on=lambda quantity: [],
            method=SimpleNamespace(damping=Damping(), artificial_viscosity=None, transfer=SimpleNamespace()),
            time=SimpleNamespace(end=1.0, max_steps=None, stop_when=None),
            events=None,
            domain=SimpleNamespace(on_exit="error"),
            archive=Archive.model_validate(archive),
            probes=probes,
        )
        return SimpleNamespace(
            scene=scene,
            units=Labels(),
            resolved=lambda: {"title": "A test"},
            plugins={},
            hash="0123456789abcdef",
            warnings=[],
            path=tmp_path / "test.yaml",
        )

    return make
