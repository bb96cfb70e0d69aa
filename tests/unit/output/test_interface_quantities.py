"""Columns, fields and probes of interfaces: only where a pair has an interface law, of the full ring."""

import numpy as np
import pytest
import yaml

from mpmcli.core.errors import SceneError
from mpmcli.core.state import ContactView, InterfaceMeans, InterfaceView
from mpmcli.output.columns import all_columns, default_columns, evaluate, fields_of, resolve_columns
from mpmcli.output.end_report import interface_facts, interfaces_in_words
from mpmcli.output.of_scene import check_output, context_of
from mpmcli.output.probes import PointProbe, grid_fields, make_probe, resolve_grid_fields
from mpmcli.output.quantities import Context
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene

PAIRS = ("a|b", "a|c", "b|c")


def context_for(kind: str = "plane_strain", **more) -> Context:
    facts = {
        "work": ("contact_work",),
        "velocity_fields": ("a", "b", "c"),
        "pairs": PAIRS,
        "interfaces": ("a|b", "b|c"),
        "cohesive": ("b|c",),
        "has_normals": True,
    }
    return Context(kind, ("a", "b", "c"), ("rubber",), **(facts | more))


@pytest.fixture
def make_joined(make_state):
    """Makes a state of three bodies, with interfaces between the first two and the last two."""

    def make(kind: str = "plane_strain"):
        state = make_state(kind, bodies=["a", "b", "c"], materials=["rubber"])
        d, rows = state.analysis.dimensions, np.arange(3.0)
        interfaces = InterfaceView(
            numbers=np.array([0, 2]),
            particle_damage=lambda: np.linspace(0.0, 1.0, state.particles.count),
            energy=1.0 + rows,
            cohesive_work=np.array([0.0, 0.0, 0.5]),
            broken_area=np.array([0.0, 0.0, 0.25]),
            means=lambda: InterfaceMeans(3.0 + rows, 0.1 * rows, 0.2 * rows, 5.0 + rows, 6.0 + rows),
            lost=4,
        )
        state.contact = ContactView(
            pairs=[tuple(pair.split("|")) for pair in PAIRS],
            force=np.zeros((3, d)),
            area=np.zeros(3),
            momentum_error=np.zeros(d),
            particle_normal=lambda: np.zeros((d, state.particles.count)),
            interfaces=interfaces,
        )
        state.work.update(contact_work=0.0, interface_work=7.5)
        return state

    return make


def table_of(state, context: Context) -> dict[str, float]:
    columns = all_columns(context)
    return dict(zip([c.name for c in columns], evaluate(columns, Snapshot(state)), strict=True))


@pytest.mark.parametrize("kind", ["uniaxial_stress", "plane_strain", "axisymmetric", "3d"])
def test_energies_and_areas_are_those_of_the_full_ring_and_means_are_not(make_joined, kind):
    table = table_of(make_joined(kind), context_for(kind))
    ring = 2.0 * np.pi if kind == "axisymmetric" else 1.0
    expected = {
        "interface_energy": 6.0 * ring,
        "interface_work": 7.5 * ring,
        "cohesive_work": 0.5 * ring,
        "interface_energy[a|b]": 1.0 * ring,
        "interface_energy[b|c]": 3.0 * ring,
        "cohesive_work[b|c]": 0.5 * ring,
        "interface_area[b|c]": 5.0 * ring,
        "broken_area[b|c]": 0.25 * ring,
        "jump_normal[b|c]": 0.2,
        "jump_tangential[b|c]": 0.4,
        "interface_traction_normal[a|b]": 5.0,
        "interface_traction_tangential[b|c]": 8.0,
        "interface_lost": 4.0,
    }
    for name, value in expected.items():
        assert table[name] == pytest.approx(value), name


def test_only_pairs_with_an_interface_law_have_columns():
    names = [column.name for column in all_columns(context_for())]
    assert "jump_normal[a|b]" in names
    assert not [name for name in names if "[a|c]" in name and name.startswith(("jump", "interface"))]
    # damage is what cohesive laws remember; elastic ones have none
    assert "broken_area[b|c]" in names
    assert "broken_area[a|b]" not in names
    assert "cohesive_work[a|b]" not in names


def test_energies_are_columns_by_default():
    names = [column.name for column in default_columns(context_for())]
    found = [n for n in names if n.split("[")[0] in {q.quantity.name for q in interface_columns()}]
    assert found == ["interface_energy", "interface_work", "cohesive_work"]
    elastic = [column.name for column in default_columns(context_for(cohesive=()))]
    assert "cohesive_work" not in elastic
    assert "interface_work" in elastic


def interface_columns():
    return [
        c
        for c in all_columns(context_for())
        if c.quantity.compute.__module__.endswith("interface_quantities")
    ]


def test_scenes_without_an_interface_law_have_none_of_it():
    plain = context_for(interfaces=(), cohesive=())
    assert len(interface_columns()) > 10
    for column in interface_columns():
        with pytest.raises(SceneError, match="does not exist in this scene"):
            resolve_columns([column.name], plain)
    assert "damage_of_bond" not in fields_of(plain)
    assert "damage_of_bond" not in fields_of(context_for(cohesive=()))
    assert not [name for name in grid_fields(plain) if name.startswith("interface")]
    wanted = ["interface_jump", "interface_traction", "interface_damage"]
    assert resolve_grid_fields(wanted, context_for()) == wanted
    with pytest.raises(SceneError):
        resolve_grid_fields(wanted[:1], plain)


@pytest.mark.parametrize("kind", ["plane_strain", "axisymmetric"])
def test_what_is_neither_stored_nor_spent_is_a_numerical_loss(make_joined, kind):
    ring = 2.0 * np.pi if kind == "axisymmetric" else 1.0
    facts = interface_facts(make_joined(kind), largest=10.0 * ring)["interfaces"]
    assert facts["loss"] == pytest.approx((7.5 - 6.0 - 0.5) * ring)
    assert facts["relative_loss"] == pytest.approx(0.1)
    words = interfaces_in_words(facts, "mJ")
    if ring == 1.0:
        assert words == (
            "interfaces took 7.5 mJ out of the bodies: 6 mJ is stored, 0.5 mJ is dissipated by damage, 1 mJ is "
            "numerical loss (10 % of the largest energy of the bodies)"
        )


def test_without_a_table_the_loss_has_no_measure_and_without_damage_no_word_of_it(make_joined):
    state = make_joined()
    state.contact.interfaces.cohesive_work[:] = 0.0
    words = interfaces_in_words(interface_facts(state, 0.0)["interfaces"], "")
    assert words == "interfaces took 7.5 out of the bodies: 6 is stored, 1.5 is numerical loss"
    state.contact.interfaces = None
    assert interface_facts(state, 1.0) == {}


def test_particles_show_damage(make_joined):
    quantity = fields_of(context_for())["damage_of_bond"]
    assert quantity.compute(Snapshot(make_joined())) == pytest.approx(np.linspace(0.0, 1.0, 6))


def test_the_balance_of_energy_counts_interfaces():
    energy_error = next(q.quantity for q in all_columns(context_for()) if q.name == "energy_error")
    assert "interface_work" in energy_error.description


# ---------------------------------------------------------------------- from scenes

SCENE = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-6, -6], "upper": [6, 6], "cell": 1},
    "materials": {"soft": {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}},
    "bodies": [
        {"name": name, "material": "soft", "region": {"kind": "box", "lower": [x, -2], "upper": [x + 3, 0]}}
        for name, x in (("left", -5), ("middle", -2), ("right", 1))
    ],
    "contact": {
        "law": {"kind": "frictionless"},
        "pairs": [
            {
                "between": ["left", "middle"],
                "law": {"kind": "linear_interface", "normal": 100.0, "tangential": 10.0},
            }
        ],
    },
    "time": {"end": 1},
}  # fmt: skip


def scene_with(**changes):
    return load_scene(yaml.safe_dump(SCENE | changes)).scene


def test_what_a_scene_says_about_interfaces():
    context = context_of(scene_with())
    assert context.interfaces == ("left|middle",)
    assert context.cohesive == ()
    law = {"kind": "linear_interface", "normal": 100.0, "tangential": "perfect"}
    assert context_of(scene_with(contact={"law": law})).interfaces == context.pairs
    assert context_of(scene_with(contact={"law": {"kind": "frictionless"}})).interfaces == ()


def test_asking_in_a_scene():
    archive = {
        "globals": {"every": 1, "columns": ["jump_normal[left|middle]", "interface_energy"]},
        "grid": {"every": 1, "fields": ["interface_traction"]},
    }
    check_output(scene_with(archive=archive))
    archive["globals"]["columns"] = ["jump_normal[middle|right]"]
    with pytest.raises(SceneError, match="jump_normal"):
        check_output(scene_with(archive=archive))


# ---------------------------------------------------------------------- probes


def test_points_see_interfaces_only_at_nodes_that_have_one(make_state, make_grid):
    """Of four nodes in contact two have an interface, one of them without a jump."""
    grid = make_grid(2)
    there, jump = np.zeros(20), np.zeros((20, 2))
    there[6] = there[7] = 1.0
    jump[6] = (0.0, 0.5)
    normal = np.ones((20, 2))
    grid.fields.update(
        interface_is_there=lambda: there, interface_jump=lambda: jump, contact_normal=lambda: normal
    )
    snapshot = Snapshot(make_state(grid=grid, step=1))
    assert PointProbe("p", (1.5, 1.75), ["interface_jump"]).look(snapshot) == pytest.approx([0.0, 0.25])
    assert np.isnan(PointProbe("q", (3.5, 2.25), ["interface_jump"]).look(snapshot)).all()


def pair_probe(**changes):
    words = {"kind": "pair", "name": "joint", "between": ["left", "middle"]} | changes
    return scene_with(probes=[words]).probes[0]


def test_probes_of_a_pair_show_its_jump_and_traction(make_joined):
    context = context_for(field_of={name: name for name in "abc"})
    probe = make_probe(pair_probe(between=["c", "b"]), make_joined(), context, "probes.0")
    assert probe.columns == [
        "jump_normal", "jump_tangential", "interface_traction_normal", "interface_traction_tangential",
    ]  # fmt: skip
    assert probe.dimensions == ["length", "length", "pressure", "pressure"]
    assert probe.look(Snapshot(make_joined())) == pytest.approx([0.2, 0.4, 7.0, 8.0])


def test_probes_of_a_pair_in_contact_show_the_force_on_the_first_of_its_names(make_joined):
    state, context = make_joined(), context_for(field_of={name: name for name in "abc"})
    state.contact.force[1] = (2.0, -3.0)
    state.contact.area[1] = 0.5
    for between, sign in ((["a", "c"], 1.0), (["c", "a"], -1.0)):
        probe = make_probe(pair_probe(between=between), state, context, "probes.0")
        assert probe.columns == ["contact_force_x", "contact_force_y", "contact_area"]
        assert probe.look(Snapshot(state)) == pytest.approx([2.0 * sign, -3.0 * sign, 0.5])


def test_wrong_words_of_pair_probes_are_scene_errors():
    good = {"kind": "pair", "name": "joint", "between": ["left", "middle"]}
    check_output(scene_with(probes=[good]))
    for changes, path, words in (
        ({"between": ["left", "left"]}, "probes.0.between", "one velocity field"),
        ({"columns": ["jump_norm"]}, "probes.0.columns.0", "did you mean 'jump_normal'"),
    ):
        with pytest.raises(SceneError, match=words) as caught:
            check_output(scene_with(probes=[good | changes]))
        assert [p.path for p in caught.value.problems] == [path]
    body, *_ = SCENE["bodies"]
    with pytest.raises(SceneError, match="several velocity fields"):
        check_output(scene_with(bodies=[body], contact=None, probes=[good]))
