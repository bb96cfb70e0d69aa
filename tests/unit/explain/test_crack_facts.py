"""What ``explain`` says about cracks: chains, nodes with several sides, cut particles, domains of tips."""

import json
from typing import Any

import pytest

from mpmcli.explain.facts import explain
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """\
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-3, -18], upper: [13, 18], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials: {glue: {kind: linear_elastic, density: 1.0e-3, E: 1000, nu: 0.33}}
bodies: [{name: plate, material: glue, region: {kind: box, lower: [0, -15], upper: [10, 15]}}]
cracks:
  - name: main
    path: {kind: points, points: [[-2, 0.3], [5, 0.3]]}
    ends: {start: mouth}
    growth: {end: {criterion: {kind: energy_release_rate, J_c: 0.2}}}
  - {name: other, path: {kind: points, points: [[2, 8], [8, 8]]}, faces: {law: {kind: coulomb, friction: 0.3}}}
fracture: {inner: 1, outer: 4}
time: {end: 0.2, courant: 0.3}
"""


def facts_of(*sets: str) -> dict[str, Any]:
    return explain(load_scene(SCENE, sets=sets))


def test_chains_sides_and_domains() -> None:
    facts = facts_of()
    json.dumps(facts)
    cracks = facts["cracks"]
    assert cracks["cracks"][0] == {
        "name": "main", "points": 15, "length": pytest.approx(7.0), "ends": ["mouth", "tip"], "law": "frictionless",
        "grows": True, "zone_cells": {}, "separation": "displacement", "pressure": None, "tractions": 0,
        "gradual": False, "moves": "average", "keep_apart": False, "respace": False,
    }  # fmt: skip
    assert [tip["tip"] for tip in cracks["tips"]] == ["main:end", "other:start", "other:end"]
    # four particles per cell in a disk of four cells around a tip
    assert cracks["tips"][0]["particles"] == pytest.approx(4 * 3.1416 * 16, rel=0.05)
    assert cracks["further_dofs"] > 3 * cracks["crack_nodes"]
    text = facts["text"]
    assert "main: 15 points, length 7, from a mouth to a tip, faces frictionless, grows" in text
    assert "other: 13 points, length 6, from a tip to a tip, faces coulomb" in text
    assert "particles in the domain of each tip: main:end " in text
    assert (
        "main:end grows at most at 152.2 (one increment while waves cross the ring)" in text
    )  # ½ cell, 4 cells
    assert "cracks: sides of nodes, faces" not in text


def test_faces_and_points() -> None:
    """Tractions, pressure, respacing, and whatever else differs from the usual, in words."""
    mode = "{shape: triangular, strength: 1, toughness: 1}"
    law = f"{{kind: cohesive, normal: {mode}, tangential: {mode}}}"
    cracks = facts_of(
        "cracks.0.growth.end.release=gradual", "cracks.0.respace=true", "cracks.0.keep_apart=true",
        "cracks.0.moves=mass", f"cracks.1.traction={{along: [2, 4], law: {law}}}", "cracks.1.pressure=2*t",
        "cracks.1.faces.separation=regression", "cracks.1.moves=fixed",
    )  # fmt: skip
    main, other = cracks["cracks"]["cracks"]
    assert (main["gradual"], main["respace"], main["keep_apart"], main["moves"]) == (True, True, True, "mass")
    assert (other["tractions"], other["pressure"], other["separation"]) == (5, "2*t", "regression")
    assert (
        "faces frictionless, grows and leaves tractions, plane moves with the mass of both sides, faces that pass the "
        "plane are put back, points are respaced"
    ) in cracks["text"]
    assert (
        "faces coulomb, their distance by regression, cohesive tractions on 5 points, pressure 2*t, plane is fixed, "
        "smallest process zone "
    ) in cracks["text"]


def test_fastest_growth() -> None:
    facts = facts_of("fracture.terms=2")["cracks"]["growth"]
    assert facts == [
        {"tip": "main:end", "speed": pytest.approx(571.0, rel=0.01), "because": "waves along a surface"}
    ]
    given = facts_of("cracks.0.growth.end.speed={max: 7}")["cracks"]["growth"]
    assert given == [{"tip": "main:end", "speed": 7.0, "because": "speed.max"}]
    steady = "cracks.0.growth.end.criterion={kind: steady_speed, speed: 3}"
    assert facts_of(steady)["cracks"]["growth"] == []


def test_scenes_without_cracks_leave_them_out() -> None:
    plain = SCENE[: SCENE.index("cracks:")] + "time: {end: 0.2, courant: 0.3}\n"
    facts = explain(load_scene(plain))
    assert facts["cracks"] == {}
    assert "cracks: sides of nodes, faces" in facts["not_modelled"]


def test_memory_of_further_sides_is_that_of_the_nodes_near_cracks() -> None:
    with_cracks = facts_of()
    plain = explain(load_scene(SCENE[: SCENE.index("cracks:")] + "time: {end: 0.2, courant: 0.3}\n"))
    more = with_cracks["grid_bytes"] - plain["grid_bytes"]
    assert 0 < more < 0.5 * plain["grid_bytes"]


def test_many_cracks_are_told_in_short() -> None:
    cracks = "".join(
        f"  - {{name: c{k}, path: {{kind: points, points: [[2, {k - 7}], [6, {k - 7}]]}}}}\n"
        for k in range(9)
    )
    text = SCENE[: SCENE.index("cracks:")] + "cracks:\n" + cracks + "time: {end: 0.2}\n"
    assert "3 more cracks of 27 points in all" in explain(load_scene(text))["text"]


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["linear", "ugimp", "bspline2"])
@pytest.mark.parametrize("y", [0.0, 0.3])
def test_cut_particles_and_crack_nodes_are_those_of_the_first_step(shape: str, y: float) -> None:
    sets = [f"method.shape={shape}", f"cracks.main.path.points=[[-2, {y}], [5, {y}]]"]
    facts = facts_of(*sets)["cracks"]
    simulation = Simulation(load_scene(SCENE, sets=sets), 1)
    simulation.step()
    assert facts["cut_particles"] == len(simulation.transfer.cut.particle)
    assert facts["crack_nodes"] == simulation.cracks.view.nodes


SMALL = (
    "grid.lower=[-3, -6]",
    "grid.upper=[9, 6]",
    "bodies.plate.region.lower=[0, -3]",
    "bodies.plate.region.upper=[6, 3]",
    "cracks.main.path.points=[[-2, 0.3], [3, 0.3]]",
    "cracks.other.path.points=[[2, 2.2], [5, 2.2]]",
    "fracture={inner: 1, outer: 2}",
)
FMPM = "method.transfer={kind: fmpm, order: 2}"
CHANGES = {
    "growth": (),
    "fmpm": (FMPM,),
    "mass": (FMPM, "cracks.main.moves=mass", "cracks.main.respace=true", "cracks.main.keep_apart=true"),
    "pressure": ("cracks.main.pressure=1",),
    "springs": ("cracks.other.faces.law={kind: linear_interface, normal: 40, tangential: perfect}",),
    "dynamic": ("fracture.terms=2", "fracture.modes=interaction"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_kernels_are_those_that_run(name: str, kernels_that_run: Any) -> None:
    loaded = load_scene(SCENE, sets=(*SMALL, *CHANGES[name]))
    assert kernels_that_run(loaded, 2) == set(explain(loaded)["kernels"])
