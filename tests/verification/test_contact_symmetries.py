"""Order of bodies, mirror images and turns by 90° change contact by nothing but round-off."""

from typing import Any

import numpy as np
import pytest
import yaml

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

STEPS = 40

# nothing lies on a grid line, where round-off may decide which nodes a body sees
DISKS = [("a", (-2.13, -1.17), 2.04, (1.1, 0.4)), ("b", (1.93, 0.71), 2.02, (-0.9, -0.3))]
THIRD = ("c", (-1.6, 3.4), 2.03, (0.4, -1.2))

# sides meet exactly amid cells: a gap of zero that round-off makes one of 1e-16, or none
AT = 2.5
MEET = {
    "head on": [("a", (-4, -2, 0, 2), AT, (1, 0.4)), ("b", (0, -2, 3, 2), AT, (-0.9, -0.3))],
    "sliding": [("a", (-4, -2, 0, 2), AT, (0, 0.4)), ("b", (0, -2, 3, 2), AT, (0, -0.3))],
}

TURNS: dict[str, Any] = {
    "mirrored": np.array([[-1, 0], [0, 1]]),
    "turned": np.array([[0, -1], [1, 0]]),
    "diagonal": np.array([[0, 1], [1, 0]]),
}


def region_of(place: tuple, size: float, turn: Any) -> dict:
    """A disk about a centre, or a box of cells of 1/3 beside a place on the diagonal; turned."""
    if len(place) == 2:
        return {"kind": "disk", "center": (turn @ np.array(place)).tolist(), "radius": size}
    corners = np.stack([turn @ (np.array(corner) / 3 + size) for corner in (place[:2], place[2:])])
    return {"kind": "box", "lower": corners.min(axis=0).tolist(), "upper": corners.max(axis=0).tolist()}


def run(
    bodies: list[Any],
    shape: str,
    transfer: dict,
    way: str = "lumped",
    turn: Any = None,
    law: dict | None = None,
    cell: float = 1,
) -> dict[str, np.ndarray]:
    """State of the bodies after some steps, sorted by body and initial place; the scene turned if asked."""
    turn = np.eye(2, dtype=int) if turn is None else turn
    members = []
    for name, place, size, velocity in bodies:
        v = [float(value) for value in turn @ np.array(velocity)]
        members.append(
            {"name": name, "material": "soft", "region": region_of(place, size, turn), "velocity": v}
        )
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-8, -8], "upper": [8, 8], "cell": cell},
        "method": {"shape": shape, "transfer": transfer},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}},
        "bodies": members,
        "contact": {"law": law or {"kind": "coulomb", "friction": 0.3}, "three_or_more": way},
        "time": {"end": 10.0, "step": 0.02 * cell},
    }
    s = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)
    p = s.particles
    first = np.empty_like(p.X)
    first[:, p.id] = turn.T @ p.X
    touched, most = 0, 0
    for _ in range(STEPS):
        s.step()
        touched += s.contact.view.touching
        most = max(most, int(np.diff(s.contact.contacts.nodes.first).max(initial=0)))
    assert touched > 0
    assert most == len(bodies)
    p, by_id = s.particles, np.argsort(s.particles.id)
    names = np.array([name for name, *_ in bodies])[p.body[by_id]]
    order = np.lexsort((*np.round(12 * first / cell), names))
    found = {"X": turn.T @ p.X[:, by_id][:, order], "V": turn.T @ p.V[:, by_id][:, order]}
    found["J"] = p.determinant()[by_id][order]
    return found


METHODS = [("lcpdi", {"kind": "flip"}), ("lcpdi", {"kind": "fmpm", "order": 4})]
METHODS += [("ugimp", {"kind": "flip"}), ("ugimp", {"kind": "fmpm", "order": 4})]
SLOW = [pytest.param(*m, marks=pytest.mark.slow if m[0] == "lcpdi" else ()) for m in METHODS]


def check(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> None:
    """Equal but for round-off that collisions have let grow."""
    for name, array in one.items():
        np.testing.assert_allclose(other[name], array, rtol=0, atol=1e-10, err_msg=name)


@pytest.mark.parametrize(("shape", "transfer"), SLOW)
@pytest.mark.parametrize("way", ["two", "lumped", "pairs", "coupled"])
def test_no_order_mirror_or_turn_matters(way, shape, transfer):
    bodies = DISKS if way == "two" else [*DISKS, THIRD]
    three = "lumped" if way == "two" else way
    straight = run(bodies, shape, transfer, three)
    check(straight, run(bodies[::-1], shape, transfer, three))
    for turn in TURNS.values():
        check(straight, run(bodies, shape, transfer, three, turn))


@pytest.mark.parametrize(
    "transfer",
    [{"kind": "flip"}, pytest.param({"kind": "fmpm", "order": 4}, marks=pytest.mark.slow)],
    ids=["flip", "fmpm"],
)
@pytest.mark.parametrize(
    ("how", "law"), [("head on", "coulomb"), pytest.param("sliding", "stick", marks=pytest.mark.slow)]
)
def test_sides_that_meet_exactly_are_in_contact_however_they_lie(how, law, transfer):
    """Neither the gap, nor the approach of sides that slide along each other, is what round-off makes of zero."""
    words = {"kind": law} | ({"friction": 0.3} if law == "coulomb" else {})
    straight = run(MEET[how], "ugimp", transfer, law=words, cell=1 / 3)
    for turn in TURNS.values():
        check(straight, run(MEET[how], "ugimp", transfer, turn=turn, law=words, cell=1 / 3))


@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 4}], ids=["flip", "fmpm"])
def test_halves_at_a_symmetry_plane_are_half_of_the_whole(transfer):
    """Forces, areas and friction work of two disks, cut along the line through their centres, are half."""

    def start(half: bool) -> Simulation:
        bodies = []
        for name, y, radius, speed in (("upper", 2.11, 2.2, -1.0), ("lower", -2.03, 1.9, 1.0)):
            region: dict[str, Any] = {"kind": "disk", "center": [0, y], "radius": radius}
            if half:
                box = {"kind": "box", "lower": [0, -8], "upper": [8, 8]}
                region = {"kind": "intersection", "regions": [region, box]}
            material = "soft" if name == "upper" else "hard"
            bodies.append({"name": name, "material": material, "region": region, "velocity": [0, speed]})
        scene = {
            "version": 1,
            "analysis": {"kind": "plane_strain"},
            "grid": {"lower": [0 if half else -8, -8], "upper": [8, 8], "cell": 1},
            "method": {"shape": "ugimp", "transfer": transfer},
            "materials": {
                "soft": {"kind": "neo_hookean", "density": 1.5, "E": 20.0, "nu": 0.4},
                "hard": {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3},
            },
            "bodies": bodies,
            "contact": {"law": {"kind": "coulomb", "friction": 0.1}},
            "time": {"end": 10.0, "step": 0.02},
        }
        if half:
            scene["boundary"] = [{"name": "middle", "kind": "symmetry", "plane": {"axis": "x", "at": 0}}]
        return Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)

    half, whole = start(True), start(False)
    for _ in range(STEPS):
        half.step()
        whole.step()
        of_half, of_whole = half.contact.view, whole.contact.view
        scale = max(1.0, abs(of_whole.force[0, 1]))
        assert 2 * of_half.force[0, 1] == pytest.approx(of_whole.force[0, 1], abs=1e-9 * scale)
        assert 2 * of_half.area[0] == pytest.approx(of_whole.area[0], abs=1e-9)
    assert of_whole.force[0, 1] > 1.0
    work = [s.state.work["contact_work"] for s in (half, whole)]
    assert work[1] > 1e-4
    assert 2 * work[0] == pytest.approx(work[1], rel=1e-8)
