"""Scenes of bodies joined by interfaces, run in the process of a test, with what they must conserve."""

from __future__ import annotations

from typing import Any

import numpy as np
import yaml
from particle_sums import ParticleSums
from scene_problems import with_keys

from mpmcli.core.state import InterfaceMeans, InterfaceView
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SOFT: dict[str, Any] = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}
JOINT: dict[str, Any] = {"kind": "linear_interface", "normal": 50.0, "tangential": 30.0}
"""φ is about 0.6 at the steps of these scenes: D Δx/E = 0.5."""


def box(
    name: str, lower: list[float], upper: list[float], velocity: list[Any] | None = None, **more: Any
) -> dict[str, Any]:
    """A body in a box."""
    region = {"kind": "box", "lower": lower, "upper": upper}
    body = {"name": name, "material": "soft", "region": region} | more
    return body | ({"velocity": velocity} if velocity else {})


class JoinedRun(ParticleSums):
    """A scene that runs; ``changes`` replace its words, ``a__b`` those of ``b`` in ``a``."""

    def __init__(self, bodies: list[dict[str, Any]], law: dict[str, Any] | None = None, **changes: Any):
        scene: dict[str, Any] = {
            "version": 1,
            "analysis": {"kind": "plane_strain"},
            "grid": {"lower": [-12, -12], "upper": [12, 12], "cell": 1},
            "method": {"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 2}},
            "materials": {"soft": SOFT},
            "bodies": bodies,
            "contact": {"law": law or JOINT},
            "time": {"end": 1000.0, "courant": 0.2},
        }
        text = yaml.safe_dump(with_keys(scene, **changes), sort_keys=False)
        self.simulation = Simulation(load_scene(text), threads=1)
        self.balance = EnergyBalance()
        self.balance.update(Snapshot(self.s.state))
        self.start = self.momentum
        self.scale = self.momentum_of_parts
        self.energy_error = self.last_error = 0.0
        self.stored = 0.0
        self.initial = self.highest = self.total

    def steps(self, count: int) -> JoinedRun:
        """Take steps; keep the largest energy error and the largest energy of the interfaces."""
        for _ in range(count):
            self.s.step()
            self.last_error = abs(self.balance.update(Snapshot(self.s.state)))
            self.energy_error = max(self.energy_error, self.last_error)
            self.stored = max(self.stored, self.joint_energy)
            self.highest = max(self.highest, self.total)
        return self

    @property
    def view(self) -> InterfaceView:
        """Interfaces of the last step."""
        view = self.s.contact.view.interfaces
        assert view is not None
        return view

    @property
    def means(self) -> InterfaceMeans:
        """Area, mean jumps and tractions of every pair in the last step."""
        return self.view.means()

    @property
    def momentum_error(self) -> float:
        """Change of momentum over Σ M |V| at the start; along the axis only, if there is one."""
        change = np.abs(self.momentum - self.start)
        if self.s.state.full_ring != 1.0:
            change = change[1:]
        return float(change.max()) / self.scale

    @property
    def joint_energy(self) -> float:
        """What all interfaces store."""
        return float(self.view.energy.sum())

    @property
    def total(self) -> float:
        """What bodies and interfaces have, and what damage has spent."""
        bodies = self.kinetic_energy + self.strain_energy
        return bodies + self.joint_energy + float(self.view.cohesive_work.sum())

    @property
    def loss(self) -> float:
        """Energy that interfaces took and neither store nor spent, over the largest that they stored."""
        work = self.s.state.work["interface_work"]
        return (work - self.joint_energy - float(self.view.cohesive_work.sum())) / self.stored

    def check(self, energy: float = 1e-3, momentum: float = 1e-11) -> None:
        """Finite, the interface has done something, energy and momentum balanced."""
        self.check_finite()
        assert self.stored > 0.0
        assert self.means.area.sum() > 0.0
        assert self.energy_error < energy
        assert self.momentum_error < momentum


class Mode:
    """The lowest antisymmetric vibration of two equal bars with free ends and a linear interface between them.

    Bars of length ``length`` along ``axis`` (0, 1, 2) meet at 0; E k L tan(k L)/L = 2 D. Exact: the jump is
    ``amplitude`` sin(ω t), and interface and bars exchange energy.
    """

    def __init__(self, length: float = 4.0, stiffness: float = 50.0, speed: float = 0.1):
        self.length, self.stiffness = length, stiffness
        self.material = {"kind": "linear_elastic", "density": 1.0, "E": 100.0, "nu": 0.0}
        low, high = 0.0, 0.5 * np.pi
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (
                (middle, high)
                if middle * np.tan(middle) < 2.0 * stiffness * length / 100.0
                else (low, middle)
            )
        self.kL = low
        self.omega = 10.0 * low / length
        self.amplitude = 2.0 * speed * np.cos(low) / self.omega
        self.speed = speed

    def velocity(self, axis: str, sign: int) -> str:
        """Velocity of the bar on the side ``sign`` at the start, as an expression of the scene."""
        return f"{sign * self.speed!r}*cos({self.kL / self.length!r}*({self.length!r} - {sign}*{axis}))"

    def jump(self, time: np.ndarray) -> np.ndarray:
        """Mean opening of the interface at these times."""
        return self.amplitude * np.sin(self.omega * time)

    @property
    def period(self) -> float:
        """Time of a whole vibration."""
        return float(2.0 * np.pi / self.omega)
