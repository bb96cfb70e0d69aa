"""Every alternative of every kind runs through its serial and its parallel kernels, to the same bytes.

Scenes choose by their size between the two; here both are made to run the same small scene. Alternatives come from the
registries, so that a new one is in.
"""

import types
import typing
from typing import Any

import examples
import numpy as np
import pytest
import yaml

from mpmcli.boundary.base import CONDITIONS, LOADS
from mpmcli.contact import nodal_contact
from mpmcli.contact.laws import LAWS
from mpmcli.contact.model import Contact
from mpmcli.contact.normals import NORMALS
from mpmcli.contact.separation import SEPARATIONS
from mpmcli.core.analysis import ANALYSES
from mpmcli.core.identity import by_identity
from mpmcli.materials import MATERIALS
from mpmcli.output.columns import all_columns, evaluate
from mpmcli.output.of_scene import context_of
from mpmcli.output.quantities import QUANTITIES
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.scene.method import UPDATES, Fmpm, Method
from mpmcli.shapes import SHAPES
from mpmcli.solver import simulation
from mpmcli.solver.simulation import Simulation

STEPS = 4
DIMENSIONS = {name: analysis().dimensions for name, analysis in ANALYSES.items()}
SOFT = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}
VELOCITY = ["0.4*sin(y+x)+0.1*z", "0.3*cos(x)", "0.2*sin(z)"]


def in_axes(d: int, words: list[str]) -> list[str]:
    """A velocity in the words of an analysis with ``d`` axes."""
    unknown = {"y": "0", "z": "0"} if d == 1 else {"z": "0"} if d == 2 else {}
    for name, zero in unknown.items():
        words = [word.replace(name, zero) for word in words]
    return words[:d]


def block(d: int, name: str = "block", at: int = 0, **keys: Any) -> dict[str, Any]:
    """A body of some cells, beside others along x by ``at`` blocks."""
    lower, upper = [0.3] * d, [0.3 + n for n in examples.CELLS[d]]
    lower[0], upper[0] = lower[0] + examples.CELLS[d][0] * at, upper[0] + examples.CELLS[d][0] * at
    region = {"kind": "box", "lower": lower, "upper": upper}
    return {"name": name, "material": "soft", "region": region, "velocity": in_axes(d, VELOCITY)} | keys


def scene_of(analysis: str = "plane_strain", blocks: int = 1, **keys: Any) -> dict[str, Any]:
    """One block that swells and turns, or several side by side."""
    d = DIMENSIONS[analysis]
    cells = examples.CELLS[d]
    return {
        "version": 1,
        "analysis": {"kind": analysis},
        "grid": {
            "lower": [0 if analysis == "axisymmetric" and a == 0 else -4 for a in range(d)],
            "upper": [n * (blocks if a == 0 else 1) + 4 for a, n in enumerate(cells)],
            "cell": 1,
        },
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
        "materials": {"soft": SOFT},
        "bodies": [block(d, f"block{i}", i) for i in range(blocks)],
        "time": {"end": 10.0, "step": 0.02},
        "archive": {"particles": {"every": 10.0, "fields": ["displacement"]}},
    } | keys


def in_contact(analysis: str = "plane_strain", **keys: Any) -> dict[str, Any]:
    """Two blocks that press and slide."""
    d = DIMENSIONS[analysis]
    speeds = [["0.5", "0.2", "0.1"], ["-0.5", "0.1*x", "0"]]
    bodies = [block(d, name, i, velocity=in_axes(d, speeds[i])) for i, name in enumerate("ab")]
    law = {"law": {"kind": "coulomb", "friction": 0.3}}
    return scene_of(analysis, 2, bodies=bodies, contact=law | keys)


def outcome(scene: dict[str, Any], parallel: bool, monkeypatch: pytest.MonkeyPatch) -> dict[str, bytes]:
    """What some steps by the serial or the parallel kernels leave: the state, and all that tables can show."""
    least = 0 if parallel else 10**9
    monkeypatch.setattr(simulation, "PARALLEL_FROM", least)
    monkeypatch.setattr(nodal_contact, "PARALLEL_CONTACTS", least)
    loaded = load_scene(yaml.safe_dump(scene, sort_keys=False))
    s = Simulation(loaded, threads=2)
    for _ in range(STEPS):
        s.step()
    found = {name: np.asarray(array).tobytes() for name, array in s.state_arrays().items()}
    s.state.X0 = by_identity(s.particles.id, s.particles.X)
    snapshot, context = Snapshot(s.state), context_of(loaded.scene, s.state)
    columns = all_columns(context)
    numbers = dict(zip((c.name for c in columns), evaluate(columns, snapshot), strict=True))
    found |= {f"column {name}": np.float64(value).tobytes() for name, value in numbers.items()}
    for quantity in QUANTITIES.at("particle"):
        if quantity.exists(context):
            found[f"field {quantity.name}"] = np.asarray(quantity.compute(snapshot)).tobytes()
    assert s.parallel == parallel
    assert numbers["kinetic_energy"] > 0
    if "contact_nodes" in numbers:
        assert numbers["contact_nodes"] > 0
        assert (s.contact.contacts.count >= s.contact.parallel_from) == parallel
    return found


@pytest.fixture
def hold_alike(monkeypatch):
    """Function (scene): serial and parallel kernels leave the same bytes."""

    def check(scene: dict[str, Any]) -> None:
        serial, parallel = (outcome(scene, parallel, monkeypatch) for parallel in (False, True))
        assert serial.keys() == parallel.keys()
        assert [name for name in serial if serial[name] != parallel[name]] == []

    return check


# ---------------------------------------------------------------------- materials and quantities

MODELS = {
    f"{kind}-{i}": examples.material(kind, numbers)
    for kind in MATERIALS
    for i, numbers in enumerate(examples.MATERIALS[kind])
}
SUPPORTED = [
    (name, analysis)
    for name, words in MODELS.items()
    for analysis in ANALYSES
    if analysis in MATERIALS[words["kind"]].analyses and words["kind"] != "rigid"
    if analysis == "plane_strain"
    or int(name.rpartition("-")[2]) < examples.IN_PLANE_STRAIN.get(words["kind"], 99)
]


EVERYWHERE = {
    f"{kind}-0"
    for kind in ("ideal_gas", "j2_plastic", "linear_elastic", "mie_gruneisen", "neo_hookean", "tait_fluid")
}
"""Examples that run in every analysis here; each analysis of another one takes 10 s to compile."""


@pytest.mark.parametrize(
    ("name", "analysis"),
    [
        pytest.param(
            name,
            analysis,
            marks=pytest.mark.slow if analysis == "plane_strain" or name in EVERYWHERE else pytest.mark.long,
        )
        for name, analysis in SUPPORTED
    ],
)
def test_materials(hold_alike, name, analysis):
    method = {
        "shape": "ugimp",
        "transfer": {"kind": "flip"},
        "heating": "adiabatic",
        "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0},
    }
    hold_alike(scene_of(analysis, materials={"soft": MODELS[name]}, method=method))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "analysis", "heating"),
    [
        ("linear_elastic-0", "plane_strain", "adiabatic"),
        ("neo_hookean-0", "plane_stress", "isothermal"),
        ("j2_plastic-0", "plane_strain", "adiabatic"),
        ("mie_gruneisen-0", "uniaxial_strain", "isothermal"),
    ],
)
def test_materials_with_heat(hold_alike, name, analysis, heating):
    """Two of them side by side in blocks of one memory, so that ranges of particles begin and end anywhere."""
    d = DIMENSIONS[analysis]
    heat = {"heat_capacity": 1.0, "conductivity": 0.5}
    expands = {} if name.startswith("mie") else {"expansion": 1e-3}
    materials = {"soft": MODELS[name] | heat | expands, "other": SOFT | heat | {"expansion": 2e-3}}
    bodies = [block(d, temperature="300 + 20*x"), block(d, "second", 1, material="other", temperature=290)]
    method = {
        "shape": "ugimp",
        "transfer": {"kind": "flip"},
        "heating": heating,
        "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0},
    }
    hold_alike(scene_of(analysis, 2, materials=materials, bodies=bodies, method=method, heat={}))


@pytest.mark.slow
def test_several_materials_at_once(hold_alike):
    names = [name for name, analysis in SUPPORTED if analysis == "plane_strain"]
    bodies = [block(2, f"block{i}", i, material=name) for i, name in enumerate(names)]
    materials = {name: MODELS[name] for name in names}
    hold_alike(scene_of(blocks=len(names), bodies=bodies, materials=materials))


def choices_of(annotation: Any) -> set[str]:
    """The words that a field may be, and the kinds of the models that it may hold."""
    if typing.get_origin(annotation) is typing.Literal:
        return set(typing.get_args(annotation))
    if isinstance(annotation, type) and hasattr(annotation, "model_fields"):
        kind = annotation.model_fields.get("kind")
        return choices_of(kind.annotation) if kind is not None else set()
    if typing.get_origin(annotation) in (typing.Union, types.UnionType, typing.Annotated):
        return set().union(*(choices_of(each) for each in typing.get_args(annotation)))
    return set()


@pytest.mark.parametrize("kind", list(MATERIALS))
def test_every_sub_model_of_a_material_is_tried(kind):
    model = MATERIALS[kind]
    tried: dict[str, set[str]] = {name: set() for name in model.model_fields}
    for numbers in examples.MATERIALS[kind]:
        made = model.model_validate(examples.material(kind, numbers))
        for name in tried:
            value = getattr(made, name)
            tried[name].add(value if isinstance(value, str) else getattr(value, "kind", ""))
    for name, field in model.model_fields.items():
        assert choices_of(field.annotation) <= tried[name], name


@pytest.mark.parametrize("name", list(MODELS))
def test_parameters_are_flat(name):
    """Numba's parallel loops take no tuple within a tuple."""
    words = MODELS[name]
    model = MATERIALS[words["kind"]].model_validate(words)
    for analysis in model.analyses:
        assert {type(value) for value in model.parameters(analysis, True)} <= {int, float, bool}


# ---------------------------------------------------------------------- shapes, updates, transfers


@pytest.mark.slow
@pytest.mark.parametrize("analysis", list(ANALYSES))
@pytest.mark.parametrize("shape", list(SHAPES))
def test_shapes(hold_alike, shape, analysis):
    hold_alike(scene_of(analysis, method={"shape": shape, "transfer": {"kind": "fmpm", "order": 3}}))


@pytest.mark.slow
@pytest.mark.parametrize("analysis", list(ANALYSES))
@pytest.mark.parametrize("shape", list(SHAPES))
def test_volume_averaging(hold_alike, shape, analysis):
    method = {"shape": shape, "transfer": {"kind": "fmpm", "order": 3}, "volumetric": "averaged"}
    hold_alike(scene_of(analysis, method=method))


@pytest.mark.slow
@pytest.mark.parametrize("analysis", list(ANALYSES))
def test_linear_increments(hold_alike, analysis):
    hold_alike(scene_of(analysis, method={"shape": "lcpdi", "deformation_increment": "linear"}))


@pytest.mark.slow
@pytest.mark.parametrize("gradient", [False, True])
@pytest.mark.parametrize("update", list(UPDATES))
def test_volume_averaging_in_updates(hold_alike, update, gradient):
    transfer = {"kind": "fmpm", "order": 3, "velocity_gradient": gradient}
    method = {"shape": "lcpdi", "update": update, "transfer": transfer, "volumetric": "averaged"}
    hold_alike(in_contact() | {"method": method})


PLAIN: list[dict[str, Any]] = [
    {"kind": "flip"},
    {"kind": "xpic", "order": 1},
    {"kind": "xpic", "order": 3},
    {"kind": "fmpm", "order": 1},
    {"kind": "fmpm", "order": 2},
    {"kind": "fmpm", "order": 4},
]
TRANSFERS = [
    *PLAIN,
    *(transfer | {"velocity_gradient": True} for transfer in PLAIN),
    {"kind": "xpic", "order": 2, "every_courant": 0.5},
    {"kind": "fmpm", "order": 4, "every_steps": 2},
    {"kind": "fmpm", "order": 4, "blend": {"order": 2, "fraction": 0.8}},
    {"kind": "fmpm", "order": 8, "dynamic": {"metric": "means", "tolerance": 0.1}},
    {"kind": "fmpm", "order": 8, "dynamic": {"metric": "changes", "tolerance": 0.1}},
]


def in_words(keys: dict[str, Any]) -> str:
    """A short name for the keys of a test."""
    return "-".join(str(value) if not isinstance(value, dict) else key for key, value in keys.items())


@pytest.mark.slow
@pytest.mark.parametrize("transfer", TRANSFERS, ids=in_words)
@pytest.mark.parametrize("update", list(UPDATES))
def test_updates_and_transfers(hold_alike, update, transfer):
    method = {
        "shape": "ugimp",
        "update": update,
        "transfer": transfer,
        "damping": {"particle": 0.1, "grid": 0.2},
    }
    hold_alike(scene_of(method=method))


@pytest.mark.slow
@pytest.mark.parametrize("damps", ["grid", "particle"])
def test_damping(hold_alike, damps):
    damping = {"grid": "0.1*t", "local": "0.2 + t", "feedback": {"damps": damps, "gain": 0.1, "target": "t"}}
    hold_alike(scene_of(method={"shape": "ugimp", "transfer": {"kind": "flip"}, "damping": damping}))


def test_every_key_of_a_transfer_is_tried():
    assert set(Fmpm.model_fields) - {"alpha"} <= set().union(*TRANSFERS)


# ---------------------------------------------------------------------- conditions and loads

WAYS = typing.get_args(Method.model_fields["velocity_conditions"].annotation)


def of_heat(kind: Any) -> dict[str, Any]:
    """What a scene needs beside a condition or load of heat."""
    if kind.acts_on != "temperature":
        return {}
    conducting = SOFT | {"heat_capacity": 1.0, "conductivity": [1.0, 0.5, 0.2]}
    return {"heat": {}, "materials": {"soft": conducting}}


def entries(words_of: Any, registry: Any) -> list[Any]:
    """(kind, dimensions, keys) of every entry of a registry of conditions or loads."""
    assert set(words_of(3)) == set(registry)
    return [
        pytest.param(d, {"kind": kind} | keys, id=f"{kind}-{i}-{d}d")
        for d in (1, 2, 3)
        for kind, several in words_of(d).items()
        for i, keys in enumerate(several)
    ]


ONE_OF = {1: "uniaxial_strain", 2: "plane_strain", 3: "3d"}


@pytest.mark.slow
@pytest.mark.parametrize(("d", "condition"), entries(examples.conditions_of, CONDITIONS))
def test_conditions(hold_alike, d, condition):
    method = {"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 3}}
    heat = of_heat(CONDITIONS[condition["kind"]])
    hold_alike(scene_of(ONE_OF[d], method=method, boundary=[{"name": "held"} | condition], **heat))


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
def test_ways_of_conditions(hold_alike, way):
    method = {"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 3}, "velocity_conditions": way}
    conditions = [
        {"name": f"held{i}", "kind": kind} | several[0]
        for i, (kind, several) in enumerate(examples.conditions_of(2).items())
        if CONDITIONS[kind].acts_on == "velocity"
    ]
    hold_alike(scene_of(method=method, boundary=conditions))


@pytest.mark.slow
@pytest.mark.parametrize(("d", "load"), entries(examples.loads_of, LOADS))
def test_loads(hold_alike, d, load):
    loads = [{"name": "load"} | load]
    if load["kind"] == "buoyancy":
        loads.append({"name": "weight", "kind": "gravity", "acceleration": [0.0] * (d - 1) + [-0.3]})
    hold_alike(scene_of(ONE_OF[d], loads=loads, **of_heat(LOADS[load["kind"]])))


@pytest.mark.slow
def test_particles_that_leave_the_grid(hold_alike):
    bodies = [block(2, "block0", 0, velocity=[40.0, 0.1])]
    hold_alike(scene_of(bodies=bodies, domain={"on_exit": "delete"}))


# ---------------------------------------------------------------------- contact


@pytest.mark.slow
@pytest.mark.parametrize("analysis", ["plane_strain", "3d"])
@pytest.mark.parametrize("kind", list(NORMALS))
def test_normals(hold_alike, kind, analysis):
    keys = {"vector": [1, 0.2, 0.1][: DIMENSIONS[analysis]]} if kind == "specified" else {}
    normal = {"kind": kind} | examples.NORMALS.get(kind, {}) | keys
    hold_alike(in_contact(analysis, normal=normal))


@pytest.mark.slow
@pytest.mark.parametrize("analysis", ["plane_strain", "3d"])
def test_surfaces_of_rigid_bodies(hold_alike, analysis):
    scene = in_contact(analysis, normal={"kind": "average_gradient", "rigid_normal": "surface"})
    scene["materials"]["hard"] = {"kind": "rigid"}
    scene["bodies"][1]["material"] = "hard"
    hold_alike(scene)


@pytest.mark.slow
@pytest.mark.parametrize("analysis", ["plane_strain", "3d"])
@pytest.mark.parametrize("kind", list(SEPARATIONS))
def test_separations(hold_alike, kind, analysis):
    hold_alike(in_contact(analysis, separation={"kind": kind} | examples.SEPARATIONS.get(kind, {})))


@pytest.mark.slow
@pytest.mark.parametrize(
    "law", [{"kind": kind} | keys for kind in LAWS for keys in examples.LAWS[kind]], ids=in_words
)
def test_laws(hold_alike, law):
    hold_alike(in_contact(law=law))


@pytest.mark.slow
@pytest.mark.parametrize("analysis", ["plane_strain", "3d"])
def test_contact_across_periodic_sides(hold_alike, analysis):
    scene = in_contact(analysis)
    scene["grid"]["periodic"] = list("xyz"[: DIMENSIONS[analysis]])
    for a in range(
        DIMENSIONS[analysis]
    ):  # blocks that meet at a side, and all but fill the period along the others
        scene["grid"]["lower"][a], scene["grid"]["upper"][a] = 0, examples.CELLS[DIMENSIONS[analysis]][a] + 1
    scene["grid"]["upper"][0] = 2 * examples.CELLS[DIMENSIONS[analysis]][0] + 1
    hold_alike(scene)


def choices_of_contact(key: str) -> tuple[str, ...]:
    """The words that a key of ``contact`` may be."""
    return typing.get_args(Contact.model_fields[key].annotation)


@pytest.mark.slow
@pytest.mark.parametrize("transfer", [*PLAIN, TRANSFERS[9]], ids=in_words)
@pytest.mark.parametrize("increments", choices_of_contact("increments"))
def test_contact_in_transfers(hold_alike, increments, transfer):
    scene = in_contact(increments=increments, overlap_removal=0.1)
    hold_alike(scene | {"method": {"shape": "lcpdi", "transfer": transfer}})


@pytest.mark.slow
@pytest.mark.parametrize("way", choices_of_contact("three_or_more"))
@pytest.mark.parametrize("rigid", [False, True])
def test_three_bodies(hold_alike, way, rigid):
    """Three blocks that meet in one point, the last one perhaps rigid."""
    materials = {"soft": SOFT, "last": {"kind": "rigid"} if rigid else SOFT}
    bodies = [
        block(
            2, name, i, velocity=[[0.5, 0], [-0.5, 0.1], [0, -0.4]][i], material=("soft", "soft", "last")[i]
        )
        for i, name in enumerate("abc")
    ]
    bodies[2]["region"] = {"kind": "box", "lower": [0.3, 14.3], "upper": [10.3, 17.3]}
    contact = {"law": {"kind": "coulomb", "friction": 0.3}, "three_or_more": way}
    grid = {"lower": [-4, -4], "upper": [14, 22], "cell": 1}
    hold_alike(scene_of(blocks=2, grid=grid, bodies=bodies, materials=materials, contact=contact))
