"""What a scene does not use costs nothing: no array, no kernel; and nothing is compiled twice."""

import json
import os
import subprocess
import sys

import pytest
import yaml

from mpmcli.core.variants import STRAIN_UPDATES
from mpmcli.explain.facts import explain
from mpmcli.scene.loader import load_scene

SCRIPT = """
import json, sys, yaml
from mpmcli.core.compiled.kernel import Kernel
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
reports = []
for scene in yaml.safe_load(sys.stdin):
    simulation = Simulation(load_scene(yaml.safe_dump(scene)))
    for _ in range(3):
        simulation.step()
    compiled = [k for k in Kernel.registered if k.compiled_signatures()]
    reports.append({
        "compiled": sorted(k.name for k in compiled),
        "registered": sorted(k.name for k in Kernel.registered),
        "signatures": sum(k.compiled_signatures() for k in compiled),
        "misses": sum(k.cache_misses() for k in compiled),
        "contact": sorted({k.name for k in compiled if k[False].py_func.__module__.startswith("mpmcli.contact")}),
        "modules": [m for m in sys.modules if m in ("vtk", "matplotlib", "pandas", "meshio", "scipy.linalg")
                    or m == "mpmcli.transport.conduction" or m.startswith("mpmcli.interfaces")],
    })
print(json.dumps(reports))
"""


def reports_of(scenes: list[dict], cache=None) -> list[dict]:
    """Run three steps of each scene in one fresh process, its compile cache in a folder or the usual place.

    What is told after a scene is the sum over it and those before.
    """
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    if cache is not None:
        environment["MPMCLI_CACHE_DIR"] = str(cache)
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], input=yaml.safe_dump(scenes), capture_output=True, text=True,
        env=environment, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def files(folder):
    """Compiled code in a folder, with the times of its last change."""
    return {path.name: path.stat().st_mtime_ns for path in folder.rglob("*.nb*")}


@pytest.fixture(scope="module")
def flip_scene():
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-4, -4], "upper": [4, 4], "cell": 1},
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.0, "E": 10.0, "nu": 0.3}},
        "bodies": [
            {"name": "block", "material": "soft", "region": {"kind": "box", "lower": [-2, -2], "upper": [2, 2]},
             "velocity": ["-0.1*x", "0"]},
        ],
        "time": {"end": 1},
    }  # fmt: skip


CONTACT = {"find_near_particles", "find_geometry", "find_impulses", "find_slip", "add_to_momenta"}
"""Some kernels of contact."""
USED = {
    "none": set(),
    "perfect": {"find_impulses", "find_slip", "add_to_momenta", "start_increments"},
    "coulomb": CONTACT | {"sum_volumes", "start_increments"},
}
"""Kernels of contact that laws use; each has those of the one before, and more."""


@pytest.fixture(scope="module")
def scenes(flip_scene):
    """A scene without contact, and two blocks under laws that use more and more kernels."""
    laws = [{"kind": "none"}, {"kind": "perfect"}, {"kind": "coulomb", "friction": 0.3}]
    assert [law["kind"] for law in laws] == list(USED)
    return [flip_scene, *(two_blocks(flip_scene, law) for law in laws)]


@pytest.fixture(scope="module")
def reports(scenes):
    """What a process says after each scene."""
    return reports_of(scenes)


def test_a_second_process_compiles_nothing(reports, scenes):
    again = reports_of(scenes)
    assert again[-1]["misses"] == 0
    assert again[-1]["signatures"] == reports[-1]["signatures"] > 0


@pytest.mark.slow
def test_a_second_process_writes_no_compiled_code(flip_scene, tmp_path):
    """Also none of the functions that kernels call; the first one began with an empty cache."""
    (first,) = reports_of([flip_scene], tmp_path)
    left = files(tmp_path)
    (second,) = reports_of([flip_scene], tmp_path)
    assert first["misses"] == first["signatures"] > 0
    assert second["misses"] == 0
    assert second["signatures"] == first["signatures"]
    assert files(tmp_path) == left, "a function was compiled again"


def test_only_kernels_of_this_scene_are_compiled(reports):
    """A FLIP scene without conditions and loads: two transfers, and what happens on nodes and in cells."""
    report = reports[0]
    assert set(report["compiled"]) == {
        "clear_nodes", "clear_sums", "counting_sort", "find_velocities", "locate_cells", "move_particles", "scatter",
        "update_momenta", "update_strain_and_stress",
    }  # fmt: skip
    assert report["signatures"] == len(report["compiled"]), "each is compiled for one set of types"
    assert len(report["registered"]) > 15


def test_without_contact_no_kernel_of_contact_is_compiled(reports):
    assert set(reports[0]["registered"]) >= CONTACT
    assert reports[0]["contact"] == []


def two_blocks(scene, law, **changes):
    first = scene["bodies"][0] | {"velocity": [0.2, 0]}
    second = {"name": "other", "material": "soft", "velocity": [-0.2, 0],
              "region": {"kind": "box", "lower": [2, -2], "upper": [3.5, 2]}}  # fmt: skip
    return scene | {"bodies": [first, second], "contact": {"law": law}} | changes


@pytest.mark.parametrize(
    ("place", "law"), list(enumerate(USED, start=1)), ids=lambda v: v if v in USED else ""
)
def test_contact_compiles_the_kernels_that_explain_names(place, law, scenes, reports):
    named = set()
    for scene in scenes[: place + 1]:
        facts = explain(load_scene(yaml.safe_dump(scene)))
        named |= {name.split("(")[0].removeprefix("contact.") for name in facts["kernels"]}
    assert set(reports[place]["contact"]) == USED[law]
    assert set(reports[place]["compiled"]) == named | {
        "clear_nodes",
        "locate_cells",
        "counting_sort",
    }  # of sorts


def test_running_imports_no_writers_and_nothing_of_heat_and_interfaces(reports):
    assert reports[-1]["modules"] == []


COMMAND = """
import json, sys
from mpmcli.cli.main import main
sys.argv = ["mpmcli", "run", "scene.yaml", "-q", "--until", "1e-9"]
try:
    main()
finally:
    print(json.dumps(sorted(m for m in sys.modules if m.startswith("mpmcli.") and "crack" in m)))
"""
KEYS_OF_CRACKS = {"", ".criteria", ".criteria.base", ".directions", ".directions.base", ".fracture", ".growth_model",
                  ".model", ".paths", ".point_laws"}  # fmt: skip
"""Modules that say which keys a scene may have."""


def test_a_run_without_cracks_imports_their_keys_and_columns_only(flip_scene, tmp_path):
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(flip_scene), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", COMMAND],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    expected = {f"mpmcli.cracks{name}" for name in KEYS_OF_CRACKS} | {"mpmcli.output.crack_quantities"}
    assert set(json.loads(done.stdout.splitlines()[-1])) == expected


def arrays_of(run) -> set[str]:
    """Names of the arrays that exist, but for those of the grid itself."""
    s = run.simulation
    damping = {
        f"damping.{name}"
        for name in ("of_forces", "of_nodes", "of_particles")
        if getattr(s.damping, name) is not None
    }
    found = set(s.nodal_arrays()) | damping | ({"X_new"} if s.arrays.X_new is not None else set())
    return found - {"grid.mp", "grid.f"}


NEEDS = [
    ({}, set()),
    ({"method__transfer": {"kind": "fmpm", "order": 1}}, {"-w"}),
    ({"method__transfer": {"kind": "fmpm", "order": 2}}, {"-w", "dv", "out"}),
    ({"method__transfer": {"kind": "xpic", "order": 2}}, {"dv", "out", "p_start"}),
    ({"method__update": "usl+"}, {"p_again", "X_new"}),
    ({"method__update": "usf"}, set()),
    ({"method__damping": {"grid": 0.1}}, {"damping.of_nodes"}),
    ({"method__damping": {"particle": 0.1}}, {"damping.of_particles"}),
    ({"method__damping": {"local": 0.1}}, {"damping.of_forces"}),
    ({"loads": [{"name": "g", "kind": "gravity", "acceleration": [0, -1]}]}, {"loads.force"}),
]


@pytest.mark.parametrize(("changes", "more"), NEEDS, ids=lambda v: "-".join(sorted(map(str, v))) or "plain")
def test_arrays_exist_only_where_they_are_needed(changes, more, block):
    """FLIP alone has the grid's mass, momentum and force, and v and a; everything else is asked for."""
    expected = {"v", "w"} | {name for name in more if not name.startswith("-")}
    expected -= {name[1:] for name in more if name.startswith("-")}
    assert arrays_of(block(**changes)) == expected


def test_particles_carry_no_history_or_viscosity_that_nobody_asked_for(block):
    p = block().particles
    assert p.H.shape[0] == 0
    assert p.viscous_pressure is None
    assert p.viscous_work is None
    viscous = block(method__artificial_viscosity={"linear": 0.2}).particles
    assert viscous.viscous_pressure.shape == (viscous.count,)


def test_particles_have_a_temperature_only_where_something_depends_on_it(block, plain_python):
    soft = {"kind": "neo_hookean", "density": 1.0, "E": 10.0, "nu": 0.3}
    metal = soft | {"kind": "j2_plastic", "hardening": {"kind": "linear", "yield_stress": 1}}
    warm = {"heat_capacity": 1.0}

    def found(material, heating="isothermal"):
        with plain_python():
            p = block(materials={"soft": material}, method__heating=heating).particles
        return {name for name in p.arrays() if name.startswith(("T", "entropy", "heat"))}

    assert found(soft | warm) == set()
    assert found(metal | warm, "adiabatic") == set()
    assert found(soft | warm, "adiabatic") == {"T"}
    assert found(soft | {"expansion": 1e-5}) == {"T"}
    assert found(metal | {"expansion": 1e-5}) == {"T", "T_stress"}


def test_a_scene_without_contact_has_no_array_of_it(block):
    s = block().steps(1).simulation
    assert s.grid.fields == 1
    assert s.grid.dof_count == s.grid.node_count
    assert s.particles.X0 is None
    assert s.particles.bond is None
    assert s.state.contact is None
    assert s.contact is s.rigid is s.loads is s.conditions is s.averaging is None


def test_a_scene_in_one_dimension_costs_one_dimension(bar):
    s = bar().simulation
    assert s.particles.X.shape[0] == 1
    assert s.grid.mp.shape == (s.grid.node_count, 2)
    assert s.grid.node_count == s.grid.cells[0] + 1 + 2 * s.grid.pad


def test_strain_updates_are_rows_of_data():
    table = {name: (row.first, row.last, row.again) for name, row in STRAIN_UPDATES.items()}
    assert table == {
        "usf": (1, 0, False), "usl": (0, 1, False), "usl+": (0, 1, True), "usavg": (0.5, 0.5, False),
        "usavg+": (0.5, 0.5, True),
    }  # fmt: skip
