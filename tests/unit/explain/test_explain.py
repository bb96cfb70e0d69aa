"""What ``explain`` says a scene will do is what it does."""

import json
from copy import deepcopy

import pytest
import yaml
from scene_problems import with_keys

from mpmcli.core.compiled.kernel import Kernel
from mpmcli.explain.facts import explain
from mpmcli.scene.loader import load_scene

BLOCKS = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-12, -6], "upper": [12, 6], "cell": 1},
    "method": {"shape": "ugimp", "update": "usl", "transfer": {"kind": "flip"}},
    "materials": {"soft": {"kind": "linear_elastic", "density": 1.0, "E": 10.0, "nu": 0.3}},
    "bodies": [
        {"name": "left", "material": "soft", "region": {"kind": "box", "lower": [-10, -2], "upper": [0, 2]}},
        {"name": "right", "material": "soft", "region": {"kind": "box", "lower": [0, -2], "upper": [10, 2]}},
    ],
    "time": {"end": 1},
}  # fmt: skip


def facts_of(contact: dict | None = None, **method) -> dict:
    scene = deepcopy(BLOCKS)
    scene["method"] |= method
    if contact is not None:
        scene["contact"] = {"law": {"kind": "coulomb", "friction": 0.3}} | contact
    return explain(load_scene(yaml.safe_dump(scene)))


def contact_kernels(facts: dict) -> set[str]:
    """Names of the kernels of contact, those of laws with the class of the law."""
    of_contact = {
        k.name for k in Kernel.registered if k[False].py_func.__module__.startswith("mpmcli.contact")
    }
    names = {name if name.startswith("find_impulses") else name.split("(")[0] for name in facts["kernels"]}
    return {name for name in names if name.split("(")[0] in of_contact}


def test_without_contact_there_is_nothing_of_it():
    facts = facts_of()
    assert facts["velocity_fields"] == 1
    assert facts["contact"] == {}
    assert not contact_kernels(facts)
    assert not [name for name in facts["arrays"] if "contact" in name]
    assert not [task for task in facts["tasks"] if "contact" in task]
    assert (
        "contact (one velocity field): nodal volumes, positions, gradients, normals" in facts["not_modelled"]
    )
    assert "1 velocity field\n" in facts["text"]


def test_the_time_step_has_the_unit_that_is_declared():
    assert " at the start: Courant" in facts_of()["text"]
    declared = BLOCKS | {"units": {"length": "mm", "mass": "g", "time": "ms"}}
    facts = explain(load_scene(yaml.safe_dump(declared)))
    assert f"time step  {facts['time_step']:.4g} ms at the start: Courant" in facts["text"]


def test_contact_says_what_it_chooses_and_what_it_looks_at():
    facts = facts_of({})
    contact = facts["contact"]
    assert facts["velocity_fields"] == 2
    assert contact["fields"] == ["left", "right"]
    assert (contact["normal"], contact["separation"]) == ("logistic_regression", "regression")
    assert contact["laws"] == ["coulomb"]
    assert 0 < contact["candidate_particles"] < facts["particles"]
    assert 0 < contact["candidate_nodes"] < facts["grid_nodes"]
    assert contact_kernels(facts) == {
        "find_near_particles", "sum_volumes", "find_geometry", "find_slip", "find_impulses(Friction)", "add_to_momenta",
        "start_increments",
    }  # fmt: skip
    assert "contact.slot_of_node" in facts["arrays"]
    assert "1.a contact on extrapolated momenta" in facts["tasks"]
    assert "3.a contact on updated momenta" in facts["tasks"]
    screen = (
        "less than 1e-05 of the mass have no contact (mass_ratio); use 1e-08 or less where interfaces cross"
    )
    for words in (
        "2 velocity fields",
        "contact of left, right: normal logistic_regression",
        "law coulomb",
        screen,
    ):
        assert words in facts["text"]
    json.dumps(facts)


def test_bodies_that_overlap_are_driven_apart_by_a_kernel_of_its_own():
    facts = facts_of({"overlap_removal": 0.05})
    assert "find_drive" in contact_kernels(facts)
    assert "find_drive" in facts["kernels_of_tasks"]["3.a contact on updated momenta"]
    assert "find_drive" not in contact_kernels(
        facts_of({"overlap_removal": 0.05, "law": {"kind": "perfect"}})
    )


def test_bodies_held_together_need_no_normals_and_no_neighbours():
    facts = facts_of({"law": {"kind": "perfect"}})
    assert facts["contact"]["normal"] is None
    assert facts["contact"]["candidate_particles"] == 0
    assert contact_kernels(facts) == {
        "find_slip",
        "start_increments",
        "find_impulses(Joined)",
        "add_to_momenta",
    }
    assert "contact normals, separations and areas" in facts["not_modelled"]
    assert "no normals" in facts["text"]


def test_bodies_that_ignore_each_other_cost_no_kernel():
    facts = facts_of({"law": {"kind": "none"}})
    assert not contact_kernels(facts)


FMPM = {"kind": "fmpm", "order": 4}


@pytest.mark.parametrize(
    ("increments", "loop", "updated", "later"),
    [("net", True, True, False), ("evolving", True, True, False), ("lumped", False, True, False),
     ("after", False, False, True), ("combined", False, True, True)],
)  # fmt: skip
def test_the_place_of_contact_in_the_fmpm_loop(increments, loop, updated, later):
    facts = facts_of({"increments": increments}, transfer=FMPM)
    tasks = facts["tasks"]
    words = "3.b velocities, FMPM loop with 3 passes"
    words += ", contact on every increment" * loop + ", then contact" * later
    assert words in tasks
    assert ("3.a contact on updated momenta" in tasks) == updated
    assert ("add_to_velocities" in facts["kernels_of_tasks"][words]) == (loop or later)
    assert ("add_to_velocities" in contact_kernels(facts)) == (loop or later)


def test_xpic_kernels_go_by_their_names():
    facts = facts_of({}, transfer={"kind": "xpic", "order": 5})
    assert {"start_projection", "next_projection", "add_projected"} <= set(facts["kernels"])
    assert "3.b velocities, XPIC filter with 4 passes, with contact corrections" in facts["tasks"]
    plain = facts_of({}, transfer={"kind": "xpic", "order": 5, "contact_correction": False})
    assert "3.b velocities, XPIC filter with 4 passes" in plain["tasks"]


def test_options_that_cost_memory_are_listed():
    plain = facts_of({})
    reuse = facts_of({"normal": {"kind": "logistic_regression", "reuse": True}})
    assert set(reuse["arrays"]) - set(plain["arrays"]) == {"contact.guesses"}
    displaced = facts_of({"separation": {"kind": "displacement"}})
    assert displaced["particle_bytes"] == plain["particle_bytes"] + 16 * plain["particles"]
    again = facts_of({"once": True}, update="usl+")
    assert "1.a contact on extrapolated momenta" not in again["tasks"]
    assert "1.a find contacts" in again["tasks"]
    assert "4.b contact on momenta extrapolated again" in again["tasks"]


def test_rigid_bodies_are_named():
    scene = deepcopy(BLOCKS)
    scene["materials"]["tool"] = {"kind": "rigid"}
    scene["bodies"][1] |= {"material": "tool", "velocity": [-1, 0]}
    scene["contact"] = {"law": {"kind": "frictionless"}}
    facts = explain(load_scene(yaml.safe_dump(scene)))
    assert facts["contact"]["rigid_fields"] == ["right"]
    assert "contact of left, right (rigid)" in facts["text"]
    assert "mass_ratio" not in facts["text"]  # one deformable field is never passed over
    assert "4 move particles and rigid bodies" in facts["tasks"]
    assert "rigid bodies" not in facts["not_modelled"]


GRADIENT = {"velocity_gradient": True}
GRAVITY = [{"name": "g", "kind": "gravity", "acceleration": [0, -1]}]
SCENES = {
    "flip": {},
    "fmpm": {"method__transfer": FMPM},
    "blended": {"method__transfer": FMPM | {"blend": {"order": 2, "fraction": 0.5}}},
    "dynamic": {"method__transfer": FMPM | {"dynamic": {"tolerance": 1e-9}}},
    "xpic": {"method__transfer": {"kind": "xpic", "order": 3}},
    "gradients": {"method__transfer": FMPM | GRADIENT},
    "gradients of flip": {"method__transfer": {"kind": "flip"} | GRADIENT},
    "gravity": {"loads": GRAVITY},
    "mirror": {"loads": GRAVITY, "boundary": [{"name": "x", "kind": "symmetry", "plane": {"axis": "x", "at": -10}}]},
    "damping": {"method__damping": {"grid": 0.1, "particle": 0.1, "local": 0.1}},
    "first and last": {"method__update": "usavg+"},
    "averaged": {"method__volumetric": "averaged"},
    "contact": {"contact": {"law": {"kind": "coulomb", "friction": 0.3}}, "method__transfer": FMPM},
    "stuck": {"contact": {"law": {"kind": "perfect"}}},
    "ignored": {"contact": {"law": {"kind": "none"}}},
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_kernels_are_those_that_run(name, kernels_that_run):
    """Every kernel that explain names is called in the first steps, and no other."""
    scene = deepcopy(BLOCKS)
    for body, x in zip(scene["bodies"], (-10, 0), strict=True):
        body["region"] |= {"lower": [x, -1], "upper": [x + 10, 0]}
    scene["bodies"][0]["velocity"] = [0.1, 0]
    loaded = load_scene(yaml.safe_dump(with_keys(scene, **SCENES[name])))
    assert kernels_that_run(loaded, 3) == set(explain(loaded)["kernels"])
