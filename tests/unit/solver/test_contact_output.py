"""What two bodies in contact show: forces, areas, normals, nodal fields; rigid bodies are no matter."""

import numpy as np
import pytest

from mpmcli.core.identity import by_identity
from mpmcli.output.columns import all_columns, evaluate
from mpmcli.output.of_scene import context_of
from mpmcli.output.probes import nodal_values
from mpmcli.output.snapshot import Snapshot

LEFT = {"name": "left", "material": "soft", "region": {"kind": "box", "lower": [-3, -2], "upper": [0, 2]},
        "velocity": [1, 0.2]}  # fmt: skip
RIGHT = {"name": "right", "material": "soft", "region": {"kind": "box", "lower": [0, -2], "upper": [3, 2]},
         "velocity": [-1, -0.2]}  # fmt: skip
WALL = {"name": "wall", "material": "tool", "region": {"kind": "box", "lower": [0, -4], "upper": [2, 4]},
        "velocity": [-0.5, 0]}  # fmt: skip
SOFT = {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}
TWO = {"bodies": [LEFT, RIGHT], "contact": {"law": {"kind": "coulomb", "friction": 0.3}}}
RIGID = {
    "materials": {"soft": SOFT, "tool": {"kind": "rigid"}},
    "bodies": [LEFT, WALL],
    "contact": {"law": {"kind": "coulomb", "friction": 0.3}},
}


def table_of(run) -> dict[str, float]:
    run.simulation.state.X0 = by_identity(run.simulation.particles.id, run.simulation.particles.X)
    columns = all_columns(context_of(run.loaded.scene, run.simulation.state))
    return dict(
        zip([c.name for c in columns], evaluate(columns, Snapshot(run.simulation.state)), strict=True)
    )


def momentum_of(run, body: int) -> np.ndarray:
    p = run.particles
    mine = p.body == body
    return (p.mass[mine] * p.V[:, mine]).sum(axis=1)


@pytest.fixture(scope="module")
def two(block):
    """Two blocks pressed together while sliding, after four steps, and the momenta before the last."""
    run = block(**TWO).steps(3)
    before = momentum_of(run, 0)
    return run.steps(1), before


def test_the_force_of_a_pair_is_what_changes_the_momentum_of_its_first(two):
    run, before = two
    table, dt = table_of(run), run.simulation.state.dt
    force = [table["contact_force_x[left|right]"], table["contact_force_y[left|right]"]]
    assert force == pytest.approx((momentum_of(run, 0) - before) / dt, rel=1e-9)
    assert force[0] < 0.0, "the right block pushes the left one back"
    assert table["contact_force_x[right]"] == pytest.approx(-force[0], rel=1e-12)
    assert table["contact_work"] > 0.0
    assert table["contact_area[left|right]"] == pytest.approx(4.0, rel=0.1)
    assert table["contact_nodes"] >= table["contact_touching"] > 0
    assert table["contact_momentum_error_x"] == 0.0


def test_sides_that_push_touch(block):
    """With FMPM, the correction of the extrapolated momenta alone may keep them apart."""
    still, planes = {"velocity": [0.0, 0.0]}, (("hold", -3.0, 0.0), ("press", 3.0, -0.003))
    run = block(
        bodies=[LEFT | still, RIGHT | still],
        contact={"law": {"kind": "frictionless"}},
        method={"transfer": {"kind": "fmpm", "order": 4}, "damping": {"grid": 10.0}},
        time={"end": 1e3, "courant": 0.02},
        boundary=[
            {
                "name": name,
                "kind": "velocity",
                "on": {"plane": {"axis": "x", "at": at}},
                "direction": "x",
                "value": v,
            }
            for name, at, v in planes
        ],
    )
    pushed = touched = 0
    for _ in range(200):
        view = run.steps(1).simulation.state.contact
        pushed, touched = pushed + (view.force[0, 0] < 0.0), touched + (view.area[0] > 0.0)
    assert touched == pushed > 100


def test_columns_of_the_scene_are_those_of_the_simulation(two):
    run, _ = two
    context = context_of(run.loaded.scene)
    assert context.pairs == tuple("|".join(pair) for pair in run.simulation.state.contact.pairs)
    assert set(context.work) == set(run.simulation.state.work)


def test_contacts_of_all_steps_are_counted(block):
    run = block(**TWO)
    counts = [
        (view.contacts, view.unconverged)
        for view in (run.steps(1).simulation.state.contact for _ in range(4))
    ]
    view = run.simulation.state.contact
    assert (view.all_contacts, view.all_unconverged) == tuple(map(sum, zip(*counts, strict=True)))
    assert view.all_contacts > view.contacts > 0


def test_normals_of_particles_point_out_of_their_body(two):
    run, _ = two
    normal = run.simulation.state.contact.particle_normal()
    p = run.particles
    shown = np.abs(normal).sum(axis=0) > 0.0
    assert shown.any()
    assert np.linalg.norm(normal[:, shown], axis=0) == pytest.approx(np.ones(shown.sum()))
    inner = shown & (np.abs(p.X[1]) < 1.0)
    assert np.all(normal[0, inner & (p.body == 0)] > 0.9)
    assert np.all(normal[0, inner & (p.body == 1)] < -0.9)
    assert np.all(np.abs(p.X[0, shown]) < 2.5), "those far from the other body have none"


def test_nodal_fields_balance_the_force(two):
    run, _ = two
    snapshot = Snapshot(run.simulation.state)
    normal, separation, traction = (
        nodal_values(snapshot, f"contact_{name}") for name in ("normal", "separation", "traction")
    )
    count = int(np.prod(run.simulation.state.grid.nodes))
    assert normal.shape == traction.shape == (count, 2)
    assert separation.shape == (count,)
    at = np.abs(normal).sum(axis=1) > 0.0
    assert at.sum() == run.simulation.state.contact.contacts
    assert not traction[~at].any()
    assert not separation[~at].any()
    contacts = run.simulation.contact.contacts
    area = contacts.geometry.area[: contacts.count]
    force = area @ traction[at]  # slots of contacts ascend with the nodes
    assert force == pytest.approx(run.simulation.state.contact.force[0], rel=1e-9)
    middle = at.reshape(17, 17)[8]
    assert separation.reshape(17, 17)[8, middle].max() < 0.0
    assert np.all((traction * normal).sum(axis=1) <= 1e-12), "they press"


def test_fields_shown_are_those_of_the_forces_when_strains_take_momenta_again(block):
    """With usl+ contact acts once more after the forces are known, which is not shown."""
    run = block(**TWO, method__update="usl+").steps(3)
    state = run.simulation.state
    traction = nodal_values(Snapshot(state), "contact_traction")
    contacts = run.simulation.contact.contacts
    at = np.abs(nodal_values(Snapshot(state), "contact_normal")).sum(axis=1) > 0.0
    assert contacts.geometry.area[: contacts.count] @ traction[at] == pytest.approx(
        state.contact.force[0], rel=1e-9
    )


def test_normals_stay_with_their_particles_when_others_are_deleted(block):
    run = block(**TWO).steps(3)
    s = run.simulation
    before = dict(zip(s.particles.id.tolist(), s.state.contact.particle_normal().T.tolist(), strict=True))
    kept = s.particles.X[1] < 1.0
    s.remove_particles(kept)
    after = s.state.contact.particle_normal()
    assert after.shape == s.particles.X.shape
    assert after.T.tolist() == [before[i] for i in s.particles.id.tolist()]
    run.steps(1)


def test_nothing_is_shown_before_the_first_step_or_apart(block):
    run = block(**TWO)
    assert not run.simulation.state.contact.particle_normal().any()
    apart = block(
        bodies=[
            LEFT | {"velocity": [-1, 0]},
            RIGHT | {"region": {"kind": "box", "lower": [5, 0], "upper": [7, 2]}},
        ],
        contact={"law": {"kind": "coulomb", "friction": 0.3}},
    ).steps(2)
    table = table_of(apart)
    assert (
        table["contact_nodes"],
        table["contact_force_x[left|right]"],
        table["contact_area[left|right]"],
    ) == (0, 0, 0)
    assert not nodal_values(Snapshot(apart.simulation.state), "contact_traction").any()


def test_bodies_joined_show_forces_but_no_normals(block):
    run = block(bodies=[LEFT, RIGHT], contact={"law": {"kind": "perfect"}}).steps(2)
    table = table_of(run)
    assert table["contact_force_x[left|right]"] < 0.0
    assert "contact_area[left|right]" not in table
    assert not run.simulation.state.contact.particle_normal().any()
    assert "contact_normal" not in run.simulation.state.grid.fields


@pytest.fixture(scope="module")
def rigid(block):
    """A block against a rigid wall that moves towards it."""
    return block(**RIGID).steps(4)


def test_a_rigid_body_is_no_matter(rigid):
    table, p = table_of(rigid), rigid.particles
    mine = p.body == 0
    assert table["mass"] == pytest.approx(18.0)
    assert table["momentum_x"] == pytest.approx(momentum_of(rigid, 0)[0])
    assert table["kinetic_energy"] == pytest.approx(
        0.5 * np.sum(p.mass[mine] * (p.V[:, mine] ** 2).sum(axis=0))
    )
    assert table["velocity_x[wall]"] == pytest.approx(-0.5)
    assert table["center_x[wall]"] == pytest.approx(1.0 - 0.5 * rigid.simulation.time)
    assert not [name for name in table if name.startswith("stress") and ("wall" in name or "tool" in name)]
    setup = rigid.simulation.setup_report.splitlines()
    assert ["rigid" in line.split() for line in setup] == [False, False, True]


def test_the_work_of_a_rigid_body_is_its_force_times_its_way(block):
    run = block(**RIGID)
    work = 0.0
    for _ in range(4):
        run.steps(1)
        table = table_of(run)
        work += table["contact_force_x[left|wall]"] * -0.5 * run.simulation.state.dt
    assert table["contact_force_x[left|wall]"] < 0.0
    assert table["rigid_work[wall]"] == pytest.approx(work, rel=1e-9)
    assert table["boundary_work"] == pytest.approx(work, rel=1e-9)


def test_the_grid_shows_matter_alone(rigid):
    snapshot = Snapshot(rigid.simulation.state)
    assert nodal_values(snapshot, "mass").sum() == pytest.approx(18.0)
    assert nodal_values(snapshot, "contact_normal").any()


def test_rigid_particles_that_leave_take_no_mass_with_them(block):
    wall = WALL | {"velocity": [40, 0], "region": {"kind": "box", "lower": [6, -4], "upper": [8, 4]}}
    run = block(**(RIGID | {"bodies": [LEFT | {"velocity": [0, 0]}, wall]}), domain={"on_exit": "delete"})
    run.steps(2)
    state = run.simulation.state
    assert state.extra["deleted_particles"] > 0
    assert state.extra["deleted_mass"] == 0.0
    assert state.work["boundary_work"] == pytest.approx(0.0, abs=1e-12)
