"""From names in a scene to columns: selection, patterns, defaults, errors."""

import pytest

from mpmcli.core.errors import SceneError
from mpmcli.output.columns import all_columns, default_columns, fields_of, resolve_columns, resolve_fields
from mpmcli.output.quantities import Context

PLAIN = Context("plane_strain", ("left", "right"), ("rubber",))


def names(columns) -> list[str]:
    return [column.name for column in columns]


def test_defaults_are_what_the_scene_uses():
    found = names(default_columns(PLAIN))
    assert found[:4] == ["kinetic_energy", "strain_energy", "stress_work", "energy_error"]
    for unused in (
        "plastic_work",
        "heat_energy",
        "viscous_work",
        "damping_work",
        "boundary_work",
        "external_work",
    ):
        assert unused not in found
    rich = Context(
        "plane_strain",
        ("left",),
        ("steel",),
        history=("plastic_work", "heat_energy"),
        reactions=("base",),
        work=("boundary_work", "external_work", "damping_work"),
        has_viscosity=True,
        extra=("deleted_mass",),
    )
    found = names(default_columns(rich))
    for used in (
        "plastic_work",
        "heat_energy",
        "viscous_work",
        "damping_work",
        "boundary_work",
        "external_work",
        "reaction_x[base]",
        "reaction_y[base]",
        "deleted_mass",
        "stress_xy[steel]",
    ):
        assert used in found
    assert len(found) == len(set(found))


def test_no_list_means_the_defaults_and_a_list_selects():
    assert names(resolve_columns(None, PLAIN)) == names(default_columns(PLAIN))
    assert names(resolve_columns(["mass", "kinetic_energy"], PLAIN)) == ["mass", "kinetic_energy"]
    assert names(resolve_columns([], PLAIN)) == []


def test_default_in_a_list_extends():
    found = names(resolve_columns(["default", "strain_xx[rubber]", "mass"], PLAIN))
    assert found == [*names(default_columns(PLAIN)), "strain_xx[rubber]"]


def test_a_name_may_stand_for_components_and_owners():
    assert names(resolve_columns(["momentum"], PLAIN)) == ["momentum_x", "momentum_y"]
    assert names(resolve_columns(["center_x"], PLAIN)) == ["center_x[left]", "center_x[right]"]
    assert names(resolve_columns(["stress[rubber]"], PLAIN)) == [
        f"stress_{c}[rubber]" for c in ("xx", "yy", "zz", "xy")
    ]
    assert names(resolve_columns(["stress_xx"], PLAIN)) == [
        "stress_xx[rubber]",
        "stress_xx[left]",
        "stress_xx[right]",
    ]


def test_asked_columns_that_the_scene_does_not_use_exist_but_contact_does_not():
    assert names(resolve_columns(["plastic_work", "damping_work"], PLAIN)) == ["plastic_work", "damping_work"]
    with pytest.raises(SceneError, match="'contact_work' does not exist in this scene \\(energy"):
        resolve_columns(["contact_work"], PLAIN)


def test_fields_that_only_other_scenes_have_are_no_misspellings():
    with pytest.raises(SceneError) as caught:
        resolve_fields(["axis_1", "strss"], PLAIN)
    absent, misspelt = (problem.message for problem in caught.value.problems)
    assert absent.startswith("'axis_1' does not exist in this scene (unit vector")
    assert "did you mean 'stress'?" in misspelt


def test_unknown_columns_are_all_reported_with_the_nearest_name():
    with pytest.raises(SceneError) as caught:
        resolve_columns(["kinetic_enrgy", "mass", "stress_xx[ruber]"], PLAIN)
    first, second = caught.value.problems
    assert (first.path, second.path) == ("archive.globals.columns.0", "archive.globals.columns.2")
    assert "did you mean 'kinetic_energy'?" in first.message
    assert "did you mean 'stress_xx[rubber]'?" in second.message


def test_columns_that_every_table_has_may_be_named():
    assert names(resolve_columns(["step", "time", "dt", "mass"], PLAIN)) == ["mass"]


def test_material_comes_before_a_body_of_the_same_name():
    context = Context("plane_strain", ("rubber",), ("rubber",))
    columns = all_columns(context)
    assert len(names(columns)) == len(set(names(columns)))
    (stress,) = [c for c in columns if c.name == "stress_xx[rubber]"]
    assert stress.quantity.where == "material"
    (center,) = [c for c in columns if c.name == "center_x[rubber]"]
    assert center.quantity.where == "body"


def test_components_follow_the_analysis():
    bar = names(all_columns(Context("uniaxial_stress", ("bar",), ("m",), reactions=("end",))))
    assert "momentum_x" in bar
    assert "momentum_y" not in bar
    assert "reaction_x[end]" in bar
    assert not any("angular" in name for name in bar)
    solid = names(all_columns(Context("3d", ("b",), ("m",))))
    assert {"momentum_z", "stress_xz[m]", "angular_momentum_x"} <= set(solid)


def test_fields_of_particles():
    context = Context("plane_strain", ("b",), ("m",), history=("equivalent_plastic_strain",))
    fields = resolve_fields(["stress", "equivalent_plastic_strain", "stress"], context)
    assert [field.name for field in fields] == ["stress", "equivalent_plastic_strain"]
    with pytest.raises(SceneError, match="did you mean 'velocity'"):
        resolve_fields(["velocty"], context)
    with pytest.raises(SceneError, match="viscous_pressure"):
        resolve_fields(["viscous_pressure"], context)


def test_works_and_energies_of_the_history_are_per_volume():
    from mpmcli.materials import MATERIALS

    history = {name for model in MATERIALS.models() for name in model.history}
    fields = fields_of(Context("plane_strain", ("b",), ("m",), history=tuple(history)))
    energies = [name for name in history if name.endswith("energy") or "work" in name]
    assert {"heat_energy", "stored_energy", "plastic_work"} <= set(energies)
    assert {fields[name].dimension for name in energies} == {"pressure"}
