"""What ``explain`` says about heat conduction."""

import json

import pytest
import yaml
from scene_problems import with_keys

from mpmcli.explain.facts import explain
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

STEEL = {
    "kind": "linear_elastic",
    "density": 1.0,
    "E": 10.0,
    "nu": 0.3,
    "heat_capacity": 2.0,
    "conductivity": 3.0,
}
SCENE = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-12, -6], "upper": [12, 6], "cell": 1},
    "method": {"shape": "ugimp", "update": "usl", "transfer": {"kind": "flip"}},
    "heat": {},
    "materials": {"steel": STEEL},
    "bodies": [
        {"name": "bar", "material": "steel", "region": {"kind": "box", "lower": [-10, -2], "upper": [10, 2]}},
    ],
    "time": {"end": 30},
}  # fmt: skip


def loaded_with(**changes):
    return load_scene(yaml.safe_dump(with_keys(SCENE, **changes)))


HEATS = {
    "flip": {},
    "flip of order 4": {"transfer": {"kind": "flip", "order": 4}},
    "fmpm": {"transfer": {"kind": "fmpm", "order": 4}},
    "fmpm at times": {"transfer": {"kind": "fmpm", "order": 4, "every_steps": 3}},
    "seldom": {"interval": 2},
    "auto": {"interval": "auto"},
}


@pytest.mark.parametrize("name", HEATS)
def test_kernels_are_those_that_run(name, kernels_that_run):
    """Every kernel that explain names is called in the first steps, and no other."""
    loaded = loaded_with(heat=HEATS[name])
    assert kernels_that_run(loaded, 6) == set(explain(loaded)["kernels"])


def facts_of(**changes):
    return explain(loaded_with(**changes))


def heat_of(**changes):
    return facts_of(**changes)["heat"]


def test_without_conduction_there_is_nothing_of_it():
    facts = facts_of(heat=None)
    assert facts["heat"] == {}
    assert "heat conduction" in facts["not_modelled"]
    assert not [name for name in facts["arrays"] if "heat" in name]
    assert not [task for task in facts["tasks"] if ".h" in task]
    assert "\nheat " not in facts["text"]


def test_conduction_says_what_it_uses():
    facts = facts_of()
    heat = facts["heat"]
    assert "heat conduction" not in facts["not_modelled"]
    assert heat["degrees_of_freedom"] == facts["grid_nodes"]
    assert heat["arrays"] == ["heat.f", "heat.mp", "heat.v"]
    assert heat["grid_bytes"] == facts["grid_nodes"] * 8 * 4
    assert heat["particle_bytes"] == facts["particles"] * 8 * 3
    assert {"find_values", "update_pairs"} <= set(heat["kernels"])
    assert set(heat["kernels"]) < set(facts["kernels"])
    json.dumps(facts)
    for words in (
        "heat       FLIP; conducted in every step;",
        "diffusivity 1.5 (steel)",
        "heat steps, in which conduction reaches 6.7 cells",
    ):
        assert words in facts["text"]


def test_full_capacity_needs_arrays_of_its_loop():
    more = heat_of(heat={"transfer": {"kind": "fmpm", "order": 4}})
    assert set(more["arrays"]) - set(heat_of()["arrays"]) == {"heat.dv"}
    assert more["particle_bytes"] < heat_of()["particle_bytes"]  # nothing is carried beside T


def test_the_margin_is_that_of_the_step_that_the_run_takes():
    facts = facts_of(time={"end": 30, "courant": 0.9})
    heat = facts["heat"]
    assert heat["fourier"] == pytest.approx(0.25)
    assert heat["margin"] == pytest.approx(0.5)
    assert facts["time_step"] == pytest.approx(0.25 / 1.5)
    assert facts["steps"] == 180
    assert "Fourier number 0.25 of a heat step, 50 % below the stable one, 0.5 (body 'bar')" in facts["text"]
    assert facts["courant"] < 0.9
    simulation = Simulation(loaded_with(time={"end": 30, "courant": 0.9}), 1)
    assert facts["time_step"] == simulation.time_step.choose(simulation.wave_speed, simulation.particle_speed)


def test_a_step_above_the_limit_may_fail():
    text = facts_of(time={"end": 30, "step": 0.5})["text"]
    assert "Fourier number 0.75 of a heat step, 50 % above the stable one, 0.5" in text
    assert "; the run may fail\n" in text


def test_intervals_are_told():
    fixed = facts_of(heat={"interval": 4, "friction": False})
    assert (fixed["heat"]["interval"], fixed["heat"]["interval_is_chosen"]) == (4, False)
    assert "FLIP; conducted in 1 of 4 steps;" in fixed["text"]
    assert "--vary heat.interval=1,4" in fixed["text"]
    auto = facts_of(heat={"interval": "auto"}, time={"end": 30, "courant": 0.05})
    assert auto["heat"]["interval_is_chosen"]
    assert (
        f"1 of {auto['heat']['interval']} steps (auto, at the start; every step while friction may heat)"
        in auto["text"]
    )
    assert auto["heat"]["heat_steps"] == auto["steps"] // auto["heat"]["interval"]
    assert auto["heat"]["interval"] > 5


def test_fmpm_tells_which_waves_it_keeps():
    facts = facts_of(heat={"transfer": {"kind": "fmpm", "order": 4, "every_steps": 3}})
    of = facts["heat"]["filter"]
    assert of["steps"] == pytest.approx(facts["heat"]["heat_steps"] / 3)
    assert (of["order"], of["body"], of["length"]) == (4, "bar", 20)
    assert facts["heat"]["removed"] == {
        "4": pytest.approx(0.0197754, rel=1e-5), "8": pytest.approx(0.000145533, rel=1e-5),
        "16": pytest.approx(6.63943e-7, rel=1e-5),
    }  # fmt: skip
    assert "FMPM(4) in 1 of 3 heat steps, FLIP in the others; conducted in every step" in facts["text"]
    assert f"FMPM(4) keeps waves longer than {of['wave']:.3g} cells (body 'bar': 20 cells)" in facts["text"]
    assert "a heat step removes of waves 0.02 of 4 cells, 0.00015 of 8 cells" in facts["text"]
    assert heat_of()["filter"] is None


def test_conduction_that_reaches_nothing_is_told():
    facts = facts_of(materials__steel__conductivity=1e-4)
    assert "conduction reaches 0.039 cells: it has no effect on this grid" in facts["text"]
    assert "no effect on this grid" not in facts_of()["text"]


def held(**place):
    return [{"name": "cold", "kind": "temperature", "value": 300, "on": place}]


def test_planes_off_grid_lines_name_the_face():
    off = facts_of(boundary=held(plane={"axis": "x", "at": -9.7}))
    assert off["heat"]["off_grid_lines"] == {"cold": pytest.approx(0.3)}
    assert (
        "condition 'cold' holds nodes, and its plane is 0.3 cells from the nearest grid line" in off["text"]
    )
    assert "hold the face of the body instead (on: {body: ..., face: ...})" in off["text"]
    on = facts_of(boundary=held(plane={"axis": "x", "at": -10}))
    face = facts_of(boundary=held(body="bar", face={"axis": "x", "side": "lower"}))
    for facts in (on, face):
        assert facts["heat"]["off_grid_lines"] == {}
        assert "hold the face" not in facts["text"]


@pytest.mark.slow
def test_splines_do_not_hold_planes_exactly():
    plane, shape = held(plane={"axis": "x", "at": -10}), "b2gimp"
    assert "held nodes of quadratic splines" in facts_of(boundary=plane, method__shape=shape)["text"]
    assert "held nodes" not in facts_of(method__shape=shape)["text"]


def test_a_period_of_one_is_redundant():
    facts = facts_of(heat={"transfer": {"kind": "fmpm", "order": 4, "every_steps": 1}})
    assert "heat.transfer.every_steps" in [found["path"] for found in facts["redundant"]]


def test_conduction_costs_less_where_it_is_seldom():
    def seconds(**heat):
        return facts_of(heat=heat, time={"end": 1e6, "step": 0.01})["estimated_seconds"]

    assert seconds() > seconds(interval=10)
    assert seconds(transfer={"kind": "fmpm", "order": 4}) > seconds()
