"""Redundant settings: named where they have no effect, and a run without them gives the same state."""

import json
from typing import Any

import numpy as np
import pytest
import yaml
from scene_problems import with_keys

from mpmcli.explain.facts import explain
from mpmcli.explain.shares import measure
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

FMPM = {"kind": "fmpm", "order": 4}
SCENE: dict[str, Any] = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-12, -6], "upper": [12, 6], "cell": 1},
    "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
    "materials": {"soft": {"kind": "linear_elastic", "density": 1.0, "E": 10.0, "nu": 0.3}},
    "bodies": [
        {"name": "left", "material": "soft", "region": {"kind": "box", "lower": [-9, -2], "upper": [-4, 2]}},
        {"name": "right", "material": "soft", "region": {"kind": "box", "lower": [4, -2], "upper": [9, 2]}},
    ],
    "time": {"end": 1, "courant": 0.2},
}
COULOMB = {"law": {"kind": "coulomb", "friction": 0.3}}
TOUCHING = {"bodies.0.region.upper": [0, 2], "bodies.1.region.lower": [0, -2]}
CLOSING = {"bodies.0.velocity": [1, 0], "bodies.1.velocity": [-1, 0]}


def loaded(changes: dict[str, Any]):
    """The scene with keys replaced, or left out where the value is None."""
    scene = with_keys(SCENE, **{key.replace(".", "__"): value for key, value in changes.items()})
    return load_scene(yaml.safe_dump({key: value for key, value in scene.items() if value is not None}))


def redundant(changes: dict[str, Any]) -> dict[str, str]:
    """Redundant keys, with the reason."""
    return {found["path"]: found["because"] for found in explain(loaded(changes))["redundant"]}


def state_after(changes: dict[str, Any], steps: int = 25) -> dict[str, np.ndarray]:
    """Particles after some steps, by identity."""
    s = Simulation(loaded(changes), threads=1)
    for _ in range(steps):
        s.step()
    order = np.argsort(s.particles.id)
    return {name: getattr(s.particles, name)[:, order] for name in ("X", "V", "tau")}


STRAINED = CLOSING | {"bodies.0.velocity": ["1 + 0.05*x", "0.03*y"]}
BLEND = {"kind": "fmpm", "order": 6}
PERFECT = TOUCHING | CLOSING

CASES = {
    # redundant key: (scene with it, without it, a scene like it where it has an effect)
    "contact.pairs.0": (
        PERFECT | {"contact": COULOMB | {"pairs": [{"between": ["left", "right"], **COULOMB}]}},
        PERFECT | {"contact": COULOMB},
        PERFECT | {"contact": COULOMB | {"pairs": [{"between": ["left", "right"], "law": {"kind": "stick"}}]}},
    ),
    "method.transfer.blend": (
        STRAINED | {"method.transfer": BLEND | {"blend": {"order": 6, "fraction": 0.5}}},
        STRAINED | {"method.transfer": BLEND},
        STRAINED | {"method.transfer": BLEND | {"blend": {"order": 5, "fraction": 0.5}}},
    ),
    "method.transfer.dynamic": (
        STRAINED | {"method.transfer": BLEND | {"order": 2, "dynamic": {}}},
        STRAINED | {"method.transfer": BLEND | {"order": 2}},
        STRAINED | {"method.transfer": BLEND | {"dynamic": {}}},
    ),
    "method.transfer.every_steps": (
        STRAINED | {"method.transfer": FMPM | {"every_steps": 1}},
        STRAINED | {"method.transfer": FMPM},
        STRAINED | {"method.transfer": FMPM | {"every_steps": 2}},
    ),
    "method.transfer.every_courant": (
        STRAINED | {"method.transfer": FMPM | {"every_courant": 0.2}},
        STRAINED | {"method.transfer": FMPM},
        STRAINED | {"method.transfer": FMPM | {"every_courant": 0.21}},
    ),
    "method.artificial_viscosity": (
        STRAINED | {"method.artificial_viscosity": {"linear": 0, "quadratic": 0}},
        STRAINED,
        STRAINED | {"method.artificial_viscosity": {"linear": 0.1, "quadratic": 0}},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_redundant_setting_is_named(name):
    with_it, without, needed = CASES[name]
    assert name in redundant(with_it)
    assert name not in redundant(without)
    assert name not in redundant(needed)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_without_it_the_state_is_the_same_to_the_last_digit(name):
    with_it, without, _ = CASES[name]
    one, other = state_after(with_it), state_after(without)
    for field, array in one.items():
        np.testing.assert_array_equal(other[field], array)


def test_output_finer_than_a_step_is_named():
    step = {"time": {"end": 1, "step": 0.01}}
    probe = [{"kind": "particle", "name": "tip", "body": "left", "near": [0, 0], "every": 0.001}]
    for name in ("particles", "globals", "grid", "checkpoint"):
        assert f"archive.{name}.every" in redundant(step | {"archive": {name: {"every": 0.005}}})
        assert not redundant(step | {"archive": {name: {"every": 0.01}}})
    assert "probes.tip.every" in redundant(step | {"probes": probe})


def test_what_only_runs_can_tell_is_a_question():
    def questions(changes: dict[str, Any]) -> str:
        return "\n".join(explain(loaded(changes))["questions"])

    assert not questions({})
    assert "--vary method.transfer=flip,fmpm:1,fmpm:2,fmpm:4,fmpm:5" in questions(
        {"method.transfer": FMPM | {"order": 5}}
    )
    assert "order" not in questions({"method.transfer": FMPM | {"dynamic": {}}})
    assert "--vary method.update=usl,usl+" in questions({"method.update": "usl+"})
    assert "velocity_gradient=false,true" in questions(
        {"method.transfer": {"kind": "flip", "velocity_gradient": True}}
    )


@pytest.mark.slow
def test_measured_shares_add_up_and_leave_the_scene_alone():
    scene = loaded(PERFECT | {"contact": COULOMB, "method.transfer": FMPM | {"order": 16}})
    found = measure(scene, threads=1, seconds=0.1)
    assert found["steps"] > 0
    assert sum(found["tasks"].values()) == pytest.approx(1.0)
    assert set(found["parts"]) == {"contact"}
    assert 0.0 < found["parts"]["contact"] < 1.0
    assert found["contact_steps"] == 1.0
    assert (found["order"], found["mean_order"], found["transfer_steps"]) == (16, 16.0, 1.0)
    assert np.isfinite(found["F"])  # which sign it has, a tenth of a second cannot tell
    assert found["F_of"] == "FMPM(16)"
    facts = explain(scene, 1, found)
    assert facts["estimated_seconds"] == pytest.approx(facts["steps"] * found["seconds_per_step"])
    assert "one more order costs F" in facts["text"]
    json.dumps(facts)


def test_a_run_too_short_to_measure_says_so():
    found = measure(loaded({"time.max_steps": 2}), threads=1, seconds=0.1)
    assert found["seconds_per_step"] is None
    assert "the run is too short" in explain(loaded({"time.max_steps": 2}), 1, found)["text"]
