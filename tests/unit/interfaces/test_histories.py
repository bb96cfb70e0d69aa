"""What particles remember of an interface stays with them."""

import numpy as np
import pytest
import yaml

from mpmcli.interfaces.base import BREAKS, HISTORY, MOST_NORMAL
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation


@pytest.fixture(autouse=True)
def in_python(plain_python):
    """Nothing is compiled."""
    with plain_python():
        yield


def parting_blocks() -> Simulation:
    """Two blocks that part, faster on the right: the joint is broken there, and damaged on the left."""
    triangle = {"shape": "triangular", "strength": 1.0, "opening": 0.2}
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-5, -5], "upper": [5, 5], "cell": 1},
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
        "materials": {"soft": {"kind": "linear_elastic", "density": 1, "E": 100, "nu": 0}},
        "bodies": [
            {"name": "low", "material": "soft", "region": {"kind": "box", "lower": [-3, -2], "upper": [3, 0]}},
            {
                "name": "high",
                "material": "soft",
                "region": {"kind": "box", "lower": [-3, 0], "upper": [3, 2]},
                "velocity": [0, "0.5*(x + 4)"],
            },
        ],
        "contact": {"law": {"kind": "cohesive", "normal": triangle, "tangential": triangle}},
        "time": {"end": 10, "step": 0.02},
    }  # fmt: skip
    return Simulation(load_scene(yaml.safe_dump(scene)), threads=1)


def by_identity(s: Simulation) -> dict[int, np.ndarray]:
    """Histories of the particles."""
    return {int(i): np.copy(kept) for i, kept in zip(s.particles.id, s.particles.interface.T, strict=True)}


def test_histories_survive_the_removal_of_particles():
    s = parting_blocks()
    for _ in range(8):
        s.step()
    before = by_identity(s)
    opened = [kept[MOST_NORMAL] for kept in before.values()]
    broken = {i for i, kept in before.items() if kept[BREAKS] > 0.5}
    assert s.particles.interface.shape[0] == HISTORY
    assert max(opened) > 0.2 > min(x for x in opened if x > 0) > 0
    assert 0 < len(broken) < len(before)
    # every third one, of both sides and at the joint too
    kept = s.particles.id % 3 > 0
    names = set(s.particles.id[kept].tolist())
    s.remove_particles(kept)
    after = by_identity(s)
    assert set(after) == names
    for i, history in after.items():
        assert np.array_equal(history, before[i])
    s.step()
    for i, history in by_identity(s).items():
        assert np.all(history >= before[i])
        assert history[BREAKS] == 1.0 or i not in broken
