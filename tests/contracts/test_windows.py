"""Every condition and load acts in the steps of its window, and in no other; kinds come from the registries."""

from typing import Any

import numpy as np
import pytest
import yaml
from examples import conditions_of, loads_of

from mpmcli.boundary.base import CONDITIONS, LOADS
from mpmcli.core.identity import by_identity
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

STEPS, DT = 5, 0.02
SOFT = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}
REGION = {"kind": "box", "lower": [0.3, 0.3], "upper": [5.3, 14.3]}
VELOCITY = ["0.4*sin(y+x)", "0.3*cos(x)"]
SCENE: dict[str, Any] = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-4, -4], "upper": [9, 18], "cell": 1},
    "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
    "bodies": [{"name": "block0", "material": "soft", "region": REGION, "velocity": VELOCITY}],
    "time": {"end": 10.0, "step": DT},
}
KINDS = [
    pytest.param("boundary", kind, several[0], id=kind)
    for kind, several in conditions_of(2).items()
    if kind != "symmetry"
] + [pytest.param("loads", kind, several[0], id=kind) for kind, several in loads_of(2).items()]


def states_of(key: str, kind: str, keys: dict[str, Any] | None) -> list[np.ndarray]:
    """Velocities and temperatures at the start and after every step; without the condition or load for None."""
    registry = CONDITIONS if key == "boundary" else LOADS
    lists: dict[str, Any] = {"boundary": [], "loads": []}
    if kind == "buoyancy":
        lists["loads"].append({"name": "weight", "kind": "gravity", "acceleration": [0.0, -0.3]})
    if keys is not None:
        lists[key].append({"name": "it", "kind": kind} | keys)
    conducting = {"heat_capacity": 1.0, "conductivity": [1.0, 0.5, 0.2]}
    is_hot = registry[kind].acts_on == "temperature"
    scene = SCENE | lists | ({"heat": {}} if is_hot else {})
    scene["materials"] = {"soft": SOFT | (conducting if is_hot else {})}
    s = Simulation(load_scene(yaml.safe_dump(scene)), threads=1)
    found = []
    for _ in range(STEPS + 1):
        p = s.particles
        found.append(by_identity(p.id, np.vstack([p.V, *([] if p.T is None else [p.T])])))
        s.step()
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("key", "kind", "keys"), KINDS)
def test_nothing_acts_outside_its_window(key, kind, keys):
    never, always = states_of(key, kind, None), states_of(key, kind, keys)
    late = states_of(key, kind, keys | {"from": 2 * DT, "until": 4 * DT})
    early = states_of(key, kind, keys | {"until": 2 * DT})
    # what holds nodes at no time takes another path, which differs by round-off
    assert [np.allclose(a, b, 1e-14, 0) for a, b in zip(late, never, strict=True)][:4] == [
        True,
        True,
        True,
        False,
    ]
    assert [np.array_equal(a, b) for a, b in zip(early, always, strict=True)][:4] == [True, True, True, False]
    assert not np.array_equal(late[4], always[4])
    never_again = states_of(key, kind, keys | {"from": 2 * DT})
    assert [np.array_equal(a, b) for a, b in zip(never_again, late, strict=True)] == [*[True] * 5, False]


def test_a_symmetry_plane_has_no_window():
    [problem] = CONDITIONS["symmetry"](
        **{"name": "m", "plane": {"axis": "x", "at": 0}, "from": 1.0}
    ).problems(2)
    assert problem == (
        "from",
        "symmetry planes act always; hold the velocity across a plane with kind: velocity",
    )
