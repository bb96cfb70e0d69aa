"""Every benchmark is translated, or refused in words; broken sources are refused with their line."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from commands import spoken
from outside.cbgeo.sources import BENCHMARKS, Benchmark, hydrostatic_column, uniaxial_traction

from mpmcli.importers.cbgeo import translate
from mpmcli.importers.scene_text import write

LARGE = {"dam_break", "plate_with_hole"}
"""Inputs of many particles; the slow test runs them coarser."""
NOT_SUPPORTED = {
    "consolidation": ["MPMExplicitTwoPhase2D", "pore_pressure_constraints"],
    "injected_particles": ["particles that appear during the run"],
    "moved_particles": ["particles with a prescribed velocity"],
}


def line_of(path: Path, word: str) -> int:
    """The first line of a file with a word."""
    return next(i for i, line in enumerate(path.read_text().splitlines(), 1) if word in line)


@pytest.mark.parametrize("name", sorted(set(BENCHMARKS) - set(NOT_SUPPORTED) - LARGE))
def test_benchmarks_are_translated(name, tmp_path):
    made = translate(BENCHMARKS[name]().write(tmp_path), partial=False)
    assert not made.problems(partial=False)
    assert made.scene["bodies"]


@pytest.mark.parametrize("name", ["mohr_coulomb_compression", "uniaxial_traction"])
def test_the_command_writes_a_valid_scene(name, tmp_path):
    source = BENCHMARKS[name]().write(tmp_path / "source")
    scene = tmp_path / "scene.yaml"
    code, written, _ = spoken(["import", "cbgeo", str(source), "-o", str(scene)])
    assert code == 0, written
    assert spoken(["validate", str(scene)])[0] == 0


@pytest.mark.parametrize("name", sorted(NOT_SUPPORTED))
def test_what_is_not_supported_is_told_with_its_line(name, tmp_path):
    source = BENCHMARKS[name]().write(tmp_path)
    code, written, _ = spoken(["import", "cbgeo", str(source)])
    assert code == 3
    for words in NOT_SUPPORTED[name]:
        assert words in written
    assert "not supported" in written
    assert re.search(rf"{re.escape(str(source))}:\d+ ", written)


def test_a_scene_as_a_person_writes_it(tmp_path):
    made = translate(uniaxial_traction().write(tmp_path), partial=False)
    scene = made.scene
    assert not made.problems(partial=False)
    assert list(scene) == [
        "version", "title", "units", "constants", "analysis", "grid", "method", "materials", "bodies",
        "boundary", "loads", "time", "archive",
    ]  # fmt: skip
    assert scene["grid"] == {"lower": [0, 0], "upper": [0.3, 0.1], "cell": 0.1}
    assert scene["bodies"][0]["region"] == {"kind": "box", "lower": [0, 0], "upper": [0.3, 0.1]}
    assert scene["bodies"][0]["particles_per_axis"] == 2
    assert scene["boundary"] == [{"name": "left", "kind": "symmetry", "plane": {"axis": "x", "at": 0}}]
    assert scene["loads"][0]["on"] == {"body": "body", "face": {"axis": "x", "side": "upper"}}
    assert scene["loads"][0]["traction"] == ["ramp(t, 0, 0.5)", 0]
    assert scene["time"] == {"end": "steps*dt", "step": "dt"}
    assert write(made) == write(translate(tmp_path / "mpm.json", partial=False))


def test_every_key_of_the_source_is_told_or_translated(tmp_path):
    made = translate(hydrostatic_column().write(tmp_path), partial=False)
    told = {note.command for note in made.of_kind("ignored")}
    assert {"mesh.isoparametric", "mesh.node_type", "analysis.uuid", "analysis.resume"} <= told
    assert all(note.line for note in made.notes)


# A broken source: what is done to the benchmark, the file and the word of the line that is told, and words.
Change = Callable[[Benchmark], Any]


def set_key(*path: Any, to: Any) -> Change:
    """Set a key of the main file."""

    def change(given: Benchmark) -> None:
        node = given.main
        for key in path[:-1]:
            node = node[key]
        node[path[-1]] = to

    return change


def no_key(*path: Any) -> Change:
    """Take a key of the main file away."""

    def change(given: Benchmark) -> None:
        node = given.main
        for key in path[:-1]:
            node = node[key]
        del node[path[-1]]

    return change


def replaced(name: str, old: str, new: str) -> Change:
    """Replace text of a file, once."""

    def change(given: Benchmark) -> None:
        assert old in given.files[name]
        given.files[name] = given.files[name].replace(old, new, 1)

    return change


MATERIAL = ("materials", 0)
CONDITION = ("mesh", "boundary_conditions", "velocity_constraints", 0)
BROKEN: dict[str, tuple[Change, str, str | int, str]] = {
    "no_density": (no_key(*MATERIAL, "density"), "mpm.json", 34, "is missing"),
    "negative_density": (set_key(*MATERIAL, "density", to=-1), "mpm.json", "density", "must be above 0"),
    "text_for_a_number": (
        set_key(*MATERIAL, "youngs_modulus", to="1e6"), "mpm.json", "youngs_modulus", "number",
    ),
    "incompressible": (
        set_key(*MATERIAL, "poisson_ratio", to=0.5), "mpm.json", "poisson_ratio", "must be below 0.5",
    ),
    "unknown_material": (set_key(*MATERIAL, "type", to="NorSand2D"), "mpm.json", "NorSand2D", "not supported"),
    "unknown_key": (
        set_key("analysis", "damped", to=1), "mpm.json", "damped", "the key is not known; did you mean 'damping'?",
    ),
    "no_such_set": (set_key(*CONDITION, "nset_id", to=7), "mpm.json", '"nset_id": 7', "there is no node set 7"),
    "no_such_axis": (set_key(*CONDITION, "dir", to=2), "mpm.json", '"dir": 2', "there is no axis 2 in 2D"),
    "no_such_function": (
        set_key("external_loading_conditions", "particle_surface_traction", 0, "math_function_id", to=3),
        "mpm.json", '"math_function_id": 3', "there is no math function 3",
    ),
    "function_goes_back": (
        set_key("math_functions", 0, "xvalues", to=[0, 1, 0.5]), "mpm.json", "xvalues", "must increase",
    ),
    "function_of_unequal_lists": (
        set_key("math_functions", 0, "xvalues", to=[0, 1]), "mpm.json", 57, "2 values",
    ),
    "no_such_material": (
        set_key("particles", 0, "generator", "material_id", to=5), "mpm.json", "material_id", "no material 5",
    ),
    "no_such_file": (
        set_key("particles", 0, "generator", "location", to="particle.txt"), "mpm.json", "location",
        "did you mean 'particles.txt'?",
    ),
    "file_outside": (
        set_key("mesh", "mesh", to="../../mesh.txt"), "mpm.json", "../../mesh.txt", "outside the folder",
    ),
    "absolute_file": (set_key("mesh", "mesh", to="/etc/passwd"), "mpm.json", "/etc/passwd", "outside the folder"),
    "triangles": (set_key("mesh", "cell_type", to="ED2T3"), "mpm.json", "ED2T3", "triangles"),
    "cells_of_3d": (set_key("mesh", "cell_type", to="ED3H8"), "mpm.json", "io_type", "does not fit"),
    "analysis_of_3d": (
        set_key("analysis", "type", to="MPMExplicit3D"), "mpm.json", "MPMExplicit3D", "does not fit",
    ),
    "implicit": (set_key("analysis", "type", to="MPMImplicit2D"), "mpm.json", "MPMImplicit2D", "not supported"),
    "no_steps": (set_key("analysis", "nsteps", to=0), "mpm.json", "nsteps", "at least 1"),
    "resumed": (
        set_key("analysis", "resume", "resume", to=True), "mpm.json", '"resume": true', "checkpoints of CB-Geo",
    ),
    "gravity_of_3d": (
        set_key("external_loading_conditions", "gravity", to=[0, 0, -9.81]), "mpm.json", "gravity", "2 components",
    ),
    "old_input": (set_key("input_files", to={}), "mpm.json", "input_files", "the input of 2018"),
    "irregular_mesh": (replaced("mesh.txt", "0.2\t0\n", "0.21\t0\n"), "mesh.txt", "0.21", "no regular grid"),
    "skewed_mesh": (replaced("mesh.txt", "0\t0.1\n", "0.05\t0.1\n"), "mesh.txt", "0\t1\t5\t4", "right angles"),
    "cell_of_far_nodes": (replaced("mesh.txt", "1\t2\t6\t5", "1\t2\t7\t5"), "mesh.txt", "1\t2\t7\t5", "corners"),
    "node_of_no_cell": (replaced("mesh.txt", "1\t2\t6\t5", "1\t2\t9\t5"), "mesh.txt", "1\t2\t9\t5", "0 to 7"),
    "short_mesh": (replaced("mesh.txt", "2\t3\t7\t6\n", ""), "mesh.txt", "8\t3", "10 rows follow"),
    "word_in_mesh": (replaced("mesh.txt", "0.2\t0\n", "0.2\tzero\n"), "mesh.txt", "zero", "'zero' is not a number"),
    "particle_outside": (
        replaced("particles.txt", "0.275\t0.075", "0.375\t0.075"), "particles.txt", "0.375", "outside the mesh",
    ),
    "particles_twice": (
        replaced("particles.txt", "0.275\t0.075", "0.275\t0.025"), "particles.txt", 13, "at the same place",
    ),
    "friction_below_zero": (
        set_key("mesh", "boundary_conditions", "friction_constraints",
                to=[{"nset_id": 1, "dir": 0, "sign_n": -1, "friction": -0.1}]),
        "mpm.json", '"friction": -0.1', "must be at least 0",
    ),
    "friction_of_free_nodes": (
        set_key("mesh", "boundary_conditions", "friction_constraints",
                to=[{"nset_id": 0, "dir": 0, "sign_n": 1, "friction": 0.1}]),
        "mpm.json", 19, "no velocity constraint holds",
    ),
    "absorbing_inside": (
        set_key("mesh", "boundary_conditions", "absorbing_constraints",
                to=[{"nset_id": 0, "dir": 1, "delta": 0.1, "h_min": 0.1, "a": 1, "b": 1}]),
        "mpm.json", 19, "no whole side of the mesh",
    ),
    "no_thickness_of_a_layer": (
        set_key("mesh", "boundary_conditions", "absorbing_constraints", to=[{"nset_id": 0, "dir": 0, "a": 1, "b": 1}]),
        "mpm.json", 19, "'delta' is missing",
    ),
    "force_without_size": (
        set_key("external_loading_conditions", "concentrated_nodal_forces", to=[{"nset_id": 0, "dir": 0}]),
        "mpm.json",
        56,
        "'force' is missing",
    ),
    "too_few_particles": (replaced("particles.txt", "12\n", "13\n"), "particles.txt", 1, "counts 13"),
    "particle_not_finite": (replaced("particles.txt", "0.275\t0.075", "nan\t0.075"), "particles.txt", "nan", "finite"),
    "set_of_no_particle": (
        replaced("entity_sets.json", "[5, 11]", "[5, 99]"), "mpm.json", "entity_sets", "particle 99",
    ),
    "set_of_words": (
        replaced("entity_sets.json", "[5, 11]", '["a"]'), "entity_sets.json", 0, "must be a valid integer",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_broken_sources(name, tmp_path):
    change, file, at, words = BROKEN[name]
    given = uniaxial_traction()
    change(given)
    source = given.write(tmp_path)
    code, written, _ = spoken(["import", "cbgeo", str(source)])
    assert code == 3
    assert words in written
    place = tmp_path / file
    line = at if isinstance(at, int) else line_of(place, at)
    assert re.search(rf"{re.escape(str(place))}:{line}[: ]" if line else re.escape(str(place)), written)
    assert "Traceback" not in written


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not valid JSON"),
        ("[]", "must be one JSON object"),
        ('{"title": "a",\n "mesh" }', "mpm.json:2:"),
        ('{"title": NaN}', "NaN is no number"),
        ("[" * 100_000, "nested too deeply"),
        ('{"title": "\x00"}', "not valid JSON"),
        ('{"title": ' + "9" * 5000 + "}", "not valid JSON"),
        ('{"mesh": {}, "mesh": {}}', "duplicate key 'mesh'"),
        ("\xff", "not UTF-8"),
    ],
)
def test_text_that_is_no_json(text, words, tmp_path):
    source = tmp_path / "mpm.json"
    source.write_bytes(text.encode("latin-1"))
    code, written, _ = spoken(["import", "cbgeo", str(source)])
    assert code == 3
    assert words in written


def test_a_partial_scene_has_the_rest_as_comments(tmp_path):
    given = uniaxial_traction()
    given.main["materials"][0]["type"] = "NorSand2D"
    source = given.write(tmp_path)
    code, written, _ = spoken(["import", "cbgeo", str(source), "--partial"])
    assert code == 0
    assert "Not supported" in written
    assert "the material 'NorSand2D'" in written
    assert "kind: linear_elastic" in written


def test_numbers_in_scientific_form_are_whole(tmp_path):
    given = uniaxial_traction()
    text = json.dumps(given.main).replace('"nsteps": 1000', '"nsteps": 1.0E+3')
    source = given.write(tmp_path)
    source.write_text(text)
    assert translate(source, partial=False).scene["constants"]["steps"] == 1000
