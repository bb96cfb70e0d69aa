"""An interface law of a plugin: a model of its own, a spring of its own, in a scene like ours."""

import math
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import pytest
import yaml

from mpmcli.contact.laws import LAWS
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.interfaces.base import InterfaceModel, jump_impulse, stored_energy
from mpmcli.interfaces.independent import Independent
from mpmcli.interfaces.springs import (
    Elastic,
    is_linear,
    is_perfect,
    no,
    oscillate,
    oscillate_nonlinear,
    pull,
    rate,
    resist,
    resist_by_pull,
    settle,
    stored,
)
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation


class YieldingInterface(InterfaceModel):
    """T = N tanh(D δ/N): stiff at first, never above N."""

    kind: Literal["yielding_interface"]
    stiffness: Annotated[float, Quantity("pressure/length", gt=0)]
    """Initial stiffness D."""
    limit: PositivePressure
    """Largest traction N."""

    @property
    def slopes(self) -> tuple[float, float]:
        """D in both directions."""
        return self.stiffness, self.stiffness

    def parameters(self) -> NamedTuple:
        """A yielding spring along the normal, an elastic one along the surface."""
        return Independent(Yielding(self.stiffness, self.limit), Elastic(self.stiffness))


class Yielding(NamedTuple):
    """D [pressure/length], N [pressure]."""

    stiffness: float
    limit: float


is_perfect.register(Yielding)(no)
is_linear.register(Yielding)(no)
resist.register(Yielding)(resist_by_pull)
oscillate.register(Yielding)(oscillate_nonlinear)


@pull.register(Yielding)
def _(spring: Any, opening: Any, most: Any) -> Any:
    return spring.limit * math.tanh(spring.stiffness * opening / spring.limit)


@rate.register(Yielding)
def _(spring: Any, opening: Any, most: Any) -> Any:
    return spring.stiffness / math.cosh(spring.stiffness * opening / spring.limit) ** 2


@stored.register(Yielding)
def _(spring: Any, opening: Any, most: Any) -> Any:
    return spring.limit**2 / spring.stiffness * math.log(math.cosh(spring.stiffness * opening / spring.limit))


@settle.register(Yielding)
def _(spring: Any, opening: Any, target: Any, compliance: Any, most: Any) -> Any:
    low, high = min(target, 0.0), max(target, 0.0)
    for _ in range(80):
        middle = 0.5 * (low + high)
        if middle + compliance * pull(spring, middle, most) > target:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


@pytest.fixture(autouse=True)
def registered(monkeypatch):
    """The law is among ours for one test."""
    monkeypatch.setitem(LAWS._modules, "yielding_interface", __name__)
    monkeypatch.setitem(LAWS._entries, "yielding_interface", YieldingInterface)


SCENE = {
    "version": 1,
    "units": {"length": "mm", "mass": "g", "time": "ms"},
    "analysis": {"kind": "uniaxial_strain"},
    "grid": {"lower": [-4], "upper": [14], "cell": 1},
    "materials": {"soft": {"kind": "linear_elastic", "E": 1000, "nu": 0, "density": 1e-3}},
    "bodies": [
        {"name": "left", "material": "soft", "region": {"kind": "box", "lower": [0], "upper": [5]}},
        {
            "name": "right",
            "material": "soft",
            "region": {"kind": "box", "lower": [5], "upper": [10]},
            "velocity": [1],
        },
    ],
    "contact": {"law": {"kind": "yielding_interface", "stiffness": "500 MPa/mm", "limit": "0.2 MPa"}},
    "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
    "time": {"end": 1.0, "step": 2e-4},
}


def test_impulse_of_a_step(plain_python):
    law = YieldingInterface(kind="yielding_interface", stiffness=500, limit=0.2).parameters()
    n, dp, jump, out = np.array([1.0]), np.array([1e-3]), np.array([1e-4]), np.zeros(1)
    with plain_python():
        for oscillates in (False, True):
            jump_impulse(law, (0.0,), dp, n, jump, np.zeros(1), 1.0, 1e-3, 1e-4, np.zeros(3), oscillates, out)
            traction = out[0] / 1e-4
            assert 0.2 * math.tanh(500 * 1e-4 / 0.2) < traction < 0.2
        assert stored_energy(law, (0.0,), n, jump, np.zeros(3)) == pytest.approx(0.5 * 500 * 1e-8, rel=0.02)


@pytest.mark.slow
def test_scene_of_a_plugin_law():
    """Two bars that part: the traction is never above the limit, the energy stored is ∫T dδ, momentum is kept."""
    s = Simulation(load_scene(yaml.safe_dump(SCENE, sort_keys=False)), threads=1)
    momentum = float((s.particles.mass * s.particles.V[0]).sum())
    for _ in range(100):
        s.step()
        traction = s.contact.interfaces.tractions()
        assert np.all(np.abs(traction) <= 0.2 * (1 + 1e-12))
    assert np.abs(traction).max() > 0.15
    assert s.contact.view.interfaces.energy.sum() > 0
    assert float((s.particles.mass * s.particles.V[0]).sum()) == pytest.approx(momentum, rel=1e-9)


def test_words_of_a_plugin_law():
    scene = SCENE | {"contact": {"law": {"kind": "yielding_interface", "stiffness": -1, "limit": "0.2 MPa"}}}
    with pytest.raises(Exception, match="must be above 0"):
        load_scene(yaml.safe_dump(scene, sort_keys=False))
