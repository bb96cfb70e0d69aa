"""A simulation that costs nothing, and a scene that asks for output."""

import errno
import os
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest
from particles_at import particles_at

from mpmcli.core.analysis import PlaneStrain
from mpmcli.core.errors import ArchiveError
from mpmcli.core.state import State
from mpmcli.output.tables import Table
from mpmcli.scene.archive import Archive
from mpmcli.scene.method import Damping


class FakeSimulation:
    """Two particles that fly; ``at`` maps a step to what happens before it."""

    threads = 2
    setup_report = "2 particles in 1 body"
    setup_warnings = ()
    dt = 0.01

    def __init__(self, loaded, threads=None):
        particles = particles_at(PlaneStrain(), np.array([[0.0, 1.0], [0.0, 0.0]]), 0.25)
        particles.V[0] = 1.0
        self.state = State(
            analysis=PlaneStrain(),
            particles=particles,
            bodies=["block"],
            materials=["rubber"],
            material_models=[SimpleNamespace(history=())],
            strain_energy_density=lambda: np.zeros(2),
            X0=particles.X.copy(),
        )
        self.at = loaded.at
        self.timings = {"4 particles": 0.5}
        loaded.simulation = self

    def state_arrays(self) -> dict:
        p = self.state.particles
        return {"X": p.X, "V": p.V, "time": self.state.time, "step": self.state.step, "dt": self.state.dt}

    def restore(self, arrays) -> None:
        p, state = self.state.particles, self.state
        p.X[:], p.V[:] = arrays["X"], arrays["V"]
        state.time, state.dt, state.step = float(arrays["time"]), float(arrays["dt"]), int(arrays["step"])

    def step(self) -> None:
        self.at.get(self.state.step, lambda: None)()
        self.state.particles.X += self.dt * self.state.particles.V
        self.state.step, self.state.dt = self.state.step + 1, self.dt
        self.state.time += self.dt


@pytest.fixture
def loaded(tmp_path):
    """What the loader returns, for a run of 100 steps; put what is to happen into ``at``."""
    scene = SimpleNamespace(
        title="Flight",
        analysis=SimpleNamespace(kind="plane_strain"),
        materials={"rubber": SimpleNamespace(kind="neo_hookean", history=(), properties=frozenset())},
        bodies=[SimpleNamespace(name="block", material="rubber")],
        contact=None,
        cracks=(),
        fracture=None,
        heat=None,
        has_temperature=False,
        conditions_on=lambda quantity: [],
        loads_on=lambda quantity: [],
        method=SimpleNamespace(
            damping=Damping(),
            artificial_viscosity=None,
            shape="lcpdi",
            update="usl",
            volumetric="local",
            transfer=SimpleNamespace(kind="flip", dynamic=None),
        ),
        time=SimpleNamespace(end=1.0, courant=0.5, max_steps=None, stop_when=None),
        domain=SimpleNamespace(on_exit="error"),
        archive=Archive.model_validate({"particles": {"every": 0.5}, "globals": {"every": 0.1}}),
        events=None,
        probes=(),
    )
    return SimpleNamespace(
        scene=scene,
        units=SimpleNamespace(label=lambda dimension: dimension),
        resolved=lambda: {"title": "Flight"},
        plugins={},
        located=nullcontext,
        hash="abc",
        file_digests={},
        overrides={"set": [], "define": []},
        allow_outside_files=False,
        warnings=[],
        path=tmp_path / "flight.yaml",
        at={},
    )


@pytest.fixture
def simulation():
    """The class of the fake simulation."""
    return FakeSimulation


@pytest.fixture
def full_disk(monkeypatch):
    """A disk on which tables have no space from row 50 on."""
    write = Table.write

    def write_or_fail(self, numbers):
        if numbers[0] >= 50:
            raise ArchiveError(f"cannot write {self.path}: {os.strerror(errno.ENOSPC)}")
        write(self, numbers)

    monkeypatch.setattr(Table, "write", write_or_fail)
    return monkeypatch
