"""Contact nodes and what they see, against brute force; contacts listed from them, and their impulses."""

import numpy as np
import pytest
import yaml

from mpmcli.contact.images import images_of
from mpmcli.contact.near_particles import row_of_particle
from mpmcli.core.grid import Grid
from mpmcli.core.transfer.stencil import SEEN, fill_stencils, is_seen
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SOFT = {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}


def box(name, lower, upper, velocity=None, **more):
    body = {"name": name, "material": "soft", "region": {"kind": "box", "lower": lower, "upper": upper}}
    return body | ({"velocity": velocity} if velocity else {}) | more


def simulation(bodies, contact=None, **changes):
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-8, -8], "upper": [8, 8], "cell": 1},
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
        "materials": {"soft": SOFT, "wall": {"kind": "rigid"}},
        "bodies": bodies,
        "contact": {"law": {"kind": "coulomb", "friction": 0.3}} | (contact or {}),
        "time": {"end": 1.0, "courant": 0.2},
    }
    return Simulation(load_scene(yaml.safe_dump(scene | changes, sort_keys=False)))


PAIR = (box("a", [-3, -2], [-0.2, 2.3], ["0.5", 0]), box("b", [0.1, -1.7], [3, 2]))
TRIO = (*PAIR, box("c", [-2, 2.4], [2.2, 4], [0, "-0.4"]))


def sights_by_node(s):
    """For each contact node the set of (particle, image, value) that it sees."""
    nodes = s.contact.nodes
    seen = {}
    for slot, node in enumerate(nodes.node):
        at, found = nodes.near.head[slot], []
        while at >= 0:
            found.append((nodes.near.particle[at], nodes.near.flag[at] & 7, nodes.near.S[at]))
            at = nodes.near.next[at]
        assert len(found) == nodes.near.number[slot]
        seen[int(node)] = found
    return seen


def stencils(s):
    """Values (N, n) of all shape functions at the particles, over the nodes of one field."""
    p, t = s.particles, s.transfer
    m, d = len(t.stencil.offsets), s.grid.dimensions
    base = np.zeros(p.count, dtype=np.uint64)
    S, G = np.zeros((p.count, m)), np.zeros((p.count, d * m))
    fill_stencils[False](t.shape.parameters, t.geometry, t.across, p.X, p.F, p.size, t.stencil, base, S, G)
    dense = np.zeros((p.count, s.grid.node_count))
    np.put_along_axis(dense, (base[:, None] + t.stencil.offsets).astype(np.int64), S, axis=1)
    return dense


@pytest.mark.parametrize("bodies", [PAIR, TRIO], ids=["two", "three"])
@pytest.mark.parametrize("shape", ["ugimp", "lcpdi", pytest.param("b2cpdi", marks=pytest.mark.slow)])
def test_contact_nodes_see_exactly_the_particles_whose_shape_functions_reach_them(bodies, shape):
    s = simulation(list(bodies), method={"shape": shape, "transfer": {"kind": "flip"}})
    for _ in range(25):
        s.step()
    sorts = -1
    while (
        sorts != s.order.version
    ):  # a step that sorts the particles leaves nothing to compare: look at the next
        sorts = s.order.version
        before = stencils(s)  # the next step looks at these positions
        s.step()
    field_of = s.particles.velocity_field
    several = [
        i for i in np.flatnonzero((before > 0).any(axis=0)) if len(set(field_of[before[:, i] > 0.0])) > 1
    ]
    seen = sights_by_node(s)
    assert sorted(seen) == several
    for node, found in seen.items():
        expected = np.flatnonzero(before[:, node] > SEEN)
        assert sorted(p for p, _, _ in found) == expected.tolist()
        for p, image, value in found:
            assert image == 0
            assert value == pytest.approx(before[p, node], rel=1e-13)


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_of_a_product_every_factor_must_be_seen(axes):
    weights = np.array([[0.5, 3e-9, 0.5], [2e-12, 0.7, 0.3], [1e-13, 0.0, 1.0]])[:axes]
    S, seen = np.ones(1), np.ones(1, dtype=bool)
    for along in weights:
        S, seen = np.outer(along, S).ravel(), np.outer(along > SEEN, seen).ravel()
    assert S[S > 0.0].min() < SEEN or axes == 1
    for a in range(3**axes):
        found = S[a] > SEEN or (S[a] > 0.0 and is_seen.py_func(S, a, 3, axes))
        assert found == seen[a]


@pytest.mark.parametrize("shift", [1e-11, 1e-9, 1e-6, 1e-4, 1e-3])
@pytest.mark.parametrize("shape", ["ugimp", "lcpdi"])
def test_normals_of_flat_sides_do_not_tilt_by_small_shifts(shape, shift):
    bodies = [box("a", [-4, -2], [0, 2], ["0.5", 0]), box("b", [0, -2], [4, 2], ["-0.5", 0])]
    s = simulation(bodies, method={"shape": shape, "transfer": {"kind": "flip"}})
    s.particles.X += shift
    s.step()
    normal = s.contact.contacts.geometry.normal[: s.contact.contacts.count]
    assert len(normal) >= 6
    np.testing.assert_allclose(normal, [[1.0, 0.0]] * len(normal), rtol=0, atol=1e-8)


def test_particles_see_whole_sides_of_nodes_after_small_shifts():
    s = simulation(list(PAIR))
    p, t = s.particles, s.transfer
    particles = np.flatnonzero(p.body == 0)
    p.X[:, particles] += np.array([[-3.0], [-2.0]]) - (p.X - p.size)[:, particles].min(axis=1, keepdims=True)
    for shift in (0.0, -1e-5, -1e-2):
        p.X[:, particles] += shift
        x = s.grid.coordinates(t.seen_nodes(particles))
        lines = [len(np.unique(along)) for along in x]
        assert x.shape[1] == lines[0] * lines[1]


def test_particles_that_see_no_contact_node_cost_nothing():
    s = simulation([box("a", [-7, -1], [-5, 1]), box("b", [5, -1], [7, 1])])
    s.step()
    assert len(s.contact.nodes.candidates.node) == 0
    assert len(s.contact.nodes.candidates.particle) == 0
    assert s.contact.nodes.count == 0


def test_images_of_planes_on_one_axis_do_not_combine():
    images = images_of([(0, 3), (1, 7), (0, 20)], Grid(np.zeros(2), np.ones(2), np.ones(2), 1, 2))
    lines = {tuple(line) for line in images.line}
    assert lines == {(3, -1), (-1, 7), (20, -1), (3, 7), (20, 7)}
    assert all(flag >> 4 == k + 1 for k, flag in enumerate(images.flag))


def test_a_mirror_shows_nodes_near_it_the_images_of_their_particles():
    plane = {"name": "mid", "kind": "symmetry", "plane": {"axis": "y", "at": -2.0}}
    s = simulation([box("a", [-3, -2], [-0.1, 2]), box("b", [0.1, -2], [3, 2])], boundary=[plane])
    s.step()
    seen = sights_by_node(s)
    coordinates = {node: s.grid.coordinates(np.array([node]))[:, 0] for node in seen}
    on_plane = [node for node in seen if coordinates[node][1] == -2.0]
    assert on_plane
    for node in on_plane:
        real = sorted((p, value) for p, image, value in seen[node] if image == 0)
        turned = sorted((p, value) for p, image, value in seen[node] if image == 2)
        assert [p for p, _ in real] == [p for p, _ in turned]
        np.testing.assert_array_equal([v for _, v in real], [v for _, v in turned])


def test_nodes_that_are_one_see_the_same_particles_at_the_same_places():
    """To the last digit, wherever a pair lies; of such nodes one counts."""
    grid = {"lower": [-8, -8], "upper": [8, 8], "cell": 1, "periodic": ["x", "y"]}
    s = simulation(list(PAIR), grid=grid, materials={"soft": SOFT})
    s.particles.X += np.array([[7.9], [5.5]])
    s.particles.X[s.particles.X >= 8.0] -= 16.0
    s.order.forget()
    s.step()
    c, g = s.contact.contacts, s.grid
    slot, home = c.fields.slot[: c.count], g.without_periods(c.nodes.node)
    seen, lists = sights_by_node(s), {}
    for node, here in zip(c.nodes.node.tolist(), home.tolist(), strict=True):
        lists.setdefault(here, []).append(seen[node])
    assert sorted({len(each) for each in lists.values()}) == [2, 4]
    assert all(each == several[0] for several in lists.values() for each in several)
    for k in range(c.count):
        first = np.flatnonzero(c.nodes.node[slot] == home[slot[k]])[0]
        for name in ("normal", "separation", "area", "distances"):
            assert np.array_equal(getattr(c.geometry, name)[k], getattr(c.geometry, name)[first])
        assert np.array_equal(c.rows.net[k], c.rows.net[first])
    view, contacts = s.contact.view, s.contact.contact_rows()
    assert view.nodes == view.contacts == len(lists) < c.count
    assert contacts.weight.sum() == len(lists)


def test_shifts_take_nodes_home():
    grid = Grid(np.zeros(2), np.array([2.0, 6.0]), np.ones(2), 2, 3, periodic=(0, 1))
    images = images_of([], grid)
    shifts = np.vstack([[0, 0], images.shift])
    nodes = np.arange(grid.node_count)
    index = np.stack([nodes % grid.shape[0], nodes // grid.shape[0]], axis=1) + shifts[images.home]
    assert np.array_equal(index[:, 0] + grid.shape[0] * index[:, 1], grid.without_periods(nodes))
    assert images.copies == len(shifts) == 7 * 3
    assert not images_of([], Grid(np.zeros(2), np.ones(2), np.ones(2), 1, 2)).flag.size


def test_two_fields_make_one_contact_per_node_and_three_one_per_field():
    s = simulation(list(TRIO))
    s.step()
    fields, first = s.contact.contacts.fields, s.contact.nodes.first
    n = s.grid.node_count
    counts = np.diff(first)
    assert set(counts) == {2, 3}
    for slot, several in enumerate(counts):
        mine = [k for k in range(s.contact.contacts.count) if fields.slot[k] == slot]
        if several == 2:
            assert len(mine) == 1
            assert fields.both[mine[0]]
            assert fields.alpha[mine[0]] < fields.partner[mine[0]]
        else:
            assert [fields.alpha[k] // n for k in mine] == [0, 1, 2]
            assert not any(fields.both[k] for k in mine)
        assert fields.alpha[mine].tolist() == sorted(fields.alpha[mine])


def test_a_rigid_field_meets_each_other_field_by_itself_after_they_have_met():
    wall = {"name": "w", "material": "wall", "region": {"kind": "box", "lower": [-4, -4], "upper": [4, -2.1]}}
    s = simulation([*PAIR[:1], box("b", [0.1, -2], [3, 2]), wall])
    s.step()
    fields, n = s.contact.contacts.fields, s.grid.node_count
    rows = range(s.contact.contacts.count)
    assert any(fields.rigid[k] for k in rows)
    for k in rows:
        if fields.rigid[k]:
            assert fields.partner[k] // n == 2
            assert fields.stage[k] == 1
            assert not fields.both[k]
        else:
            assert fields.stage[k] == 0
            assert 2 not in (fields.alpha[k] // n, fields.partner[k] // n)


def test_small_shares_of_mass_are_passed_over_unless_the_bond_is_perfect():
    for law, passed_over in (("stick", True), ("perfect", False)):
        s = simulation(list(PAIR), {"law": {"kind": law}, "mass_ratio": 0.3})
        s.step()
        mp, nodes, c = s.grid.mp, s.contact.nodes, s.contact.contacts
        shares = []
        for slot in range(nodes.count):
            m = mp[nodes.dof[nodes.first[slot] : nodes.first[slot + 1]], 0]
            shares.append(m.min() / m.sum())
        wanted = sum(share >= 0.3 for share in shares) if passed_over else len(shares)
        assert min(shares) < 0.3 < max(shares)
        assert c.count == wanted


@pytest.mark.parametrize(
    "transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 3}, {"kind": "xpic", "order": 3}]
)
@pytest.mark.parametrize("update", ["usf", "usl+", "usavg"])
def test_contact_of_two_fields_keeps_momentum(transfer, update):
    s = simulation(list(PAIR), method={"shape": "ugimp", "update": update, "transfer": transfer})
    before = (s.particles.mass * s.particles.V).sum(axis=1)
    for _ in range(60):
        s.step()
    after = (s.particles.mass * s.particles.V).sum(axis=1)
    b = s.particles.body == 1
    assert np.abs((s.particles.mass * s.particles.V)[:, b].sum(axis=1)).max() > 1.0
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-11)


def test_forces_of_the_table_are_what_the_bodies_gain():
    s = simulation(list(PAIR))
    while s.contact.view.touching == 0:
        s.step()
    b = s.particles.body == 0
    before = (s.particles.mass * s.particles.V)[:, b].sum(axis=1)
    s.step()
    b = s.particles.body == 0
    after = (s.particles.mass * s.particles.V)[:, b].sum(axis=1)
    assert np.abs(s.contact.view.force).max() > 0.0
    np.testing.assert_allclose((after - before) / s.state.dt, s.contact.view.force[0], rtol=1e-9, atol=1e-9)


def test_no_particle_has_a_row_without_cracks():
    assert row_of_particle(None, 3) == -1
