"""Columns and fields of contact; rigid bodies count in no sum over matter."""

import numpy as np
import pytest
import yaml

from mpmcli.core.errors import SceneError
from mpmcli.core.state import ContactView
from mpmcli.output.columns import all_columns, default_columns, evaluate, fields_of, resolve_columns
from mpmcli.output.contact_quantities import MOST_PAIRS
from mpmcli.output.of_scene import check_output, context_of
from mpmcli.output.probes import PointProbe, grid_fields, nodal_values, resolve_grid_fields
from mpmcli.output.quantities import Context
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene

PLAIN = Context("plane_strain", ("left", "right"), ("rubber", "steel"))


def context_for(kind: str = "plane_strain", **more) -> Context:
    facts = {
        "work": ("contact_work",),
        "velocity_fields": ("left", "right", "punch"),
        "rigid_fields": ("punch",),
        "rigid_bodies": ("punch",),
        "rigid_materials": ("tool",),
        "pairs": ("left|right", "left|punch", "right|punch"),
        "has_normals": True,
    }
    return Context(kind, ("left", "right", "punch"), ("rubber", "tool"), **(facts | more))


def view_for(d: int, count: int = 6) -> ContactView:
    force = np.arange(1.0, 3 * d + 1.0).reshape(3, d)
    return ContactView(
        pairs=[("left", "right"), ("left", "punch"), ("right", "punch")],
        force=force,
        area=np.array([0.5, 0.25, 0.125]),
        momentum_error=np.arange(1.0, d + 1.0),
        particle_normal=lambda: np.full((d, count), 0.5),
        nodes=7,
        touching=5,
        contacts=9,
        unconverged=2,
        rigid_work={"punch": 3.0},
    )


def table_of(state, context: Context) -> dict[str, float]:
    columns = all_columns(context)
    return dict(zip([c.name for c in columns], evaluate(columns, Snapshot(state)), strict=True))


@pytest.fixture
def make_touching(make_state):
    """Makes a state of three bodies in contact, of which the last is rigid."""

    def make(kind: str = "plane_strain", **more):
        state = make_state(
            kind, bodies=["left", "right", "punch"], materials=["rubber", "tool"], rigid=(2,), **more
        )
        p = state.particles
        p.body[:] = np.arange(p.count) % 3
        p.material[:] = p.body == 2
        state.contact = view_for(state.analysis.dimensions)
        state.work["contact_work"] = 1.5
        return state

    return make


# ---------------------------------------------------------------------- values


@pytest.mark.parametrize("kind", ["uniaxial_stress", "plane_strain", "3d"])
def test_forces_areas_and_counts(make_touching, kind):
    table = table_of(make_touching(kind), context_for(kind))
    d = len(table_axes(kind))
    for axis, name in enumerate(table_axes(kind)):
        first, second, third = (float(1 + axis + d * row) for row in range(3))
        assert table[f"contact_force_{name}[left|right]"] == first
        assert table[f"contact_force_{name}[right|punch]"] == third
        assert table[f"contact_force_{name}[left]"] == first + second
        assert table[f"contact_force_{name}[right]"] == third - first
        assert table[f"contact_force_{name}[punch]"] == -second - third
        assert table[f"contact_momentum_error_{name}"] == 1.0 + axis
    assert table["contact_area[left|punch]"] == 0.25
    assert table["contact_work"] == 1.5
    assert table["rigid_work[punch]"] == 3.0
    assert (table["contact_nodes"], table["contact_touching"], table["contact_unconverged"]) == (7, 5, 2)


def table_axes(kind: str) -> str:
    return {"uniaxial_stress": "x", "3d": "xyz"}.get(kind, "xy")


def test_axisymmetric_contact_is_that_of_the_full_ring(make_touching):
    """As for reactions: the radial component is summed around the ring; the error of momentum is axial."""
    table = table_of(make_touching("axisymmetric"), context_for("axisymmetric"))
    ring = 2.0 * np.pi
    assert table["contact_force_x[left|right]"] == pytest.approx(ring * 1.0)
    assert table["contact_force_y[left|right]"] == pytest.approx(ring * 2.0)
    assert table["contact_area[left|right]"] == pytest.approx(ring * 0.5)
    assert table["contact_work"] == pytest.approx(ring * 1.5)
    assert table["rigid_work[punch]"] == pytest.approx(ring * 3.0)
    assert table["contact_momentum_error_y"] == pytest.approx(ring * 2.0)
    assert "contact_momentum_error_x" not in table
    assert table["contact_nodes"] == 7


def test_particles_have_normals(make_touching):
    quantity = fields_of(context_for())["contact_normal"]
    assert quantity.compute(Snapshot(make_touching())).shape == (2, 6)


def test_rigid_bodies_count_in_no_sum(make_touching):
    state = make_touching()
    state.particles.tau[:, state.particles.body == 2] = 1e6
    p, table = state.particles, table_of(state, context_for())
    soft = p.body != 2
    assert table["mass"] == pytest.approx(p.mass[soft].sum())
    assert table["kinetic_energy"] == pytest.approx(0.5 * np.sum((p.mass * (p.V**2).sum(axis=0))[soft]))
    assert table["momentum_x"] == pytest.approx(np.sum((p.mass * p.V[0])[soft]))
    moments = p.mass * (p.X[0] * p.V[1] - p.X[1] * p.V[0])
    assert table["angular_momentum_z"] == pytest.approx(moments[soft].sum())
    assert table["stress_work"] == pytest.approx(p.stress_work[soft].sum())
    assert table["smallest_J"] == pytest.approx(p.determinant()[soft].min())
    assert table["largest_speed"] == pytest.approx(np.linalg.norm(p.V, axis=0).max())
    assert table["center_x[punch]"] == pytest.approx(np.average(p.X[0, ~soft], weights=p.mass[~soft]))
    assert table["velocity_y[punch]"] == pytest.approx(np.average(p.V[1, ~soft], weights=p.mass[~soft]))
    assert not [
        name for name in table if name.startswith(("stress_xx[punch", "stress_xx[tool", "strain_xx[punch"))
    ]
    assert np.isfinite(list(table.values())).all()


def test_rigid_particles_have_no_mass_but_a_place(make_touching):
    snapshot, fields = Snapshot(make_touching()), fields_of(context_for())
    rigid = snapshot.is_rigid
    assert rigid.sum() == 2
    for name in ("mass", "density", "kinetic_energy"):
        assert np.array_equal(fields[name].compute(snapshot) == 0.0, rigid), name
    for name in ("position", "velocity", "volume"):
        assert np.all(fields[name].compute(snapshot) != 0.0), name


# ---------------------------------------------------------------------- which columns there are


def names(columns) -> list[str]:
    return [column.name for column in columns]


def test_default_columns_of_contact():
    found = names(default_columns(context_for()))
    assert found[0] == "kinetic_energy"
    for name in (
        "contact_work",
        "contact_nodes",
        "contact_force_y[left|punch]",
        "rigid_work[punch]",
        "center_x[punch]",
    ):
        assert name in found
    for name in (
        "contact_area[left|right]",
        "contact_touching",
        "contact_force_x[left]",
        "contact_momentum_error_x",
    ):
        assert name not in found
    assert "contact_momentum_error_x" in names(default_columns(context_for(creates_momentum=True)))


def test_many_pairs_are_columns_only_where_asked():
    fields = tuple(f"b{i}" for i in range(6))
    pairs = tuple(f"{a}|{b}" for a in fields for b in fields if a < b)
    assert len(pairs) > MOST_PAIRS
    context = Context("3d", fields, ("m",), work=("contact_work",), velocity_fields=fields, pairs=pairs)
    assert not [name for name in names(default_columns(context)) if name.startswith("contact_force")]
    assert names(resolve_columns(["contact_force_x[b0|b1]"], context)) == ["contact_force_x[b0|b1]"]
    assert len(resolve_columns(["contact_force"], context)) == 3 * (len(pairs) + len(fields))


def test_one_pair_and_one_component_of_all():
    assert names(resolve_columns(["contact_force[left|right]"], context_for())) == [
        "contact_force_x[left|right]", "contact_force_y[left|right]",
    ]  # fmt: skip
    assert names(resolve_columns(["contact_area"], context_for())) == [
        "contact_area[left|right]", "contact_area[left|punch]", "contact_area[right|punch]",
    ]  # fmt: skip
    with pytest.raises(SceneError, match=r"did you mean 'contact_force_x\["):
        resolve_columns(["contact_force_x[right|left]"], context_for())


CONTACT_COLUMNS = [
    "contact_force", "contact_area", "contact_work", "contact_nodes", "contact_touching", "contact_unconverged",
    "contact_momentum_error_x", "rigid_work",
]  # fmt: skip


@pytest.mark.parametrize("name", CONTACT_COLUMNS)
def test_scenes_without_contact_have_none_of_it(name):
    resolve_columns([name], context_for())
    with pytest.raises(SceneError, match="does not exist in this scene"):
        resolve_columns([name], PLAIN)


def test_bodies_held_together_know_no_area():
    context = context_for(has_normals=False)
    assert names(resolve_columns(["contact_force_x[left|right]"], context))
    for name in ("contact_area", "contact_unconverged"):
        with pytest.raises(SceneError):
            resolve_columns([name], context)
    assert "contact_normal" not in fields_of(context)
    assert "contact_traction" not in grid_fields(context)


# ---------------------------------------------------------------------- nodal fields


def test_grid_fields_of_contact():
    wanted = ["contact_normal", "contact_separation", "contact_traction", "contact_normal"]
    assert resolve_grid_fields(wanted, context_for()) == wanted[:3]
    with pytest.raises(SceneError) as caught:
        resolve_grid_fields(["mass", "contact_normal", "speed"], PLAIN)
    assert [p.path for p in caught.value.problems] == ["archive.grid.fields.1", "archive.grid.fields.2"]


def test_points_see_contact_only_at_nodes_that_have_it(make_state, make_grid):
    grid = make_grid(2)
    normal = np.zeros((20, 2))
    normal[6] = normal[7] = (0.0, 1.0)
    separation = np.where(normal[:, 1] > 0.0, -0.25, 0.0)
    grid.fields.update(contact_normal=lambda: normal, contact_separation=lambda: separation)
    snapshot = Snapshot(make_state("axisymmetric", grid=grid, step=1))
    probe = PointProbe("p", (1.5, 1.75), ["contact_normal", "contact_separation"])
    assert probe.columns == ["contact_normal_x", "contact_normal_y", "contact_separation"]
    assert probe.dimensions == ["1", "1", "length"]
    assert probe.look(snapshot) == pytest.approx([0.0, 1.0, -0.25])
    assert np.isnan(PointProbe("q", (3.5, 2.25), ["contact_normal"]).look(snapshot)).all()
    assert nodal_values(snapshot, "contact_separation")[6] == -0.25


# ---------------------------------------------------------------------- from scenes

SCENE = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-6, -6], "upper": [6, 6], "cell": 1},
    "materials": {
        "soft": {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3},
        "tool": {"kind": "rigid"},
    },
    "bodies": [
        {"name": "block", "material": "soft", "region": {"kind": "box", "lower": [-2, -2], "upper": [2, 0]}},
        {"name": "punch", "material": "tool", "region": {"kind": "box", "lower": [-1, 0], "upper": [1, 2]},
         "velocity": [0, -1]},
        {"name": "base", "material": "tool", "region": {"kind": "box", "lower": [-4, -4], "upper": [4, -2]}},
    ],
    "contact": {"law": {"kind": "frictionless"}},
    "time": {"end": 1},
    "archive": {"globals": {"every": 0.1}, "particles": {"every": 0.1}, "grid": {"every": 0.1}},
}  # fmt: skip


def scene_with(**changes):
    return load_scene(yaml.safe_dump(SCENE | changes)).scene


def test_what_a_scene_says_about_contact():
    context = context_of(scene_with())
    assert context.velocity_fields == ("block", "punch", "base")
    assert context.rigid_fields == context.rigid_bodies == ("punch", "base")
    assert context.rigid_materials == ("tool",)
    assert context.pairs == ("block|punch", "block|base")
    assert context.has_normals
    assert not context.creates_momentum
    assert {"contact_work", "boundary_work"} <= set(context.work)


def test_fields_may_be_those_of_materials_and_know_no_normals():
    context = context_of(scene_with(contact={"fields": "material", "law": {"kind": "perfect"}}))
    assert context.pairs == ("soft|tool",)
    assert not context.has_normals


def test_one_field_is_no_contact():
    body, *_ = SCENE["bodies"]
    context = context_of(scene_with(bodies=[body], contact={"law": {"kind": "stick"}}))
    assert not context.has_contact
    assert context.work == ()


def test_asking_in_a_scene():
    archive = {
        "globals": {"every": 1, "columns": ["contact_force_y[block|punch]", "contact_area"]},
        "particles": {"every": 1, "fields": ["contact_normal"]},
        "grid": {"every": 1, "fields": ["contact_traction"]},
    }
    check_output(scene_with(archive=archive))
    body, *_ = SCENE["bodies"]
    alone = {key: value for key, value in SCENE.items() if key != "contact"} | {
        "bodies": [body],
        "archive": archive,
    }
    with pytest.raises(SceneError) as caught:
        check_output(load_scene(yaml.safe_dump(alone)).scene)
    assert {p.path for p in caught.value.problems} == {
        "archive.globals.columns.0", "archive.globals.columns.1", "archive.particles.fields.0", "archive.grid.fields.0",
    }  # fmt: skip
