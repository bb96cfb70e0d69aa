"""Bodies in contact that are cracked, against bodies that no crack cuts, and against rigid ones."""

import numpy as np
import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-8, -10], upper: [8, 10], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials:
  m: {kind: linear_elastic, E: 1000, nu: 0.33, density: 0.001}
  r: {kind: rigid}
bodies:
  - {name: low, material: m, region: {kind: box, lower: [-6, -8], upper: [6, 0]}, velocity: ["0.2*x", 3]}
  - {name: high, material: m, region: {kind: box, lower: [-5, 0], upper: [5, 7]}, velocity: ["0.2*x", -3]}
contact: {law: {kind: coulomb, friction: 0.3}}
cracks:
  - {name: main, path: {kind: points, points: [[0.2, -4.3], [0.2, 3.1]]}}
time: {end: 1.0, courant: 0.3}
"""
FMPM = "{kind: fmpm, order: 4}"


def start(*changes: tuple[str, str]) -> Simulation:
    text = SCENE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return Simulation(load_scene(text))


def momentum(s: Simulation) -> np.ndarray:
    p = s.particles
    moves = ~np.isin(p.body, s.state.rigid)
    return (p.mass * p.V)[:, moves].sum(axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("transfer", ["{kind: flip}", FMPM])
@pytest.mark.parametrize("cuts", ["", ", ends: {end: mouth}, cuts: [low]"], ids=["both", "one"])
def test_cracked_bodies_in_contact_conserve_momentum(transfer, cuts):
    s = start(("{kind: flip}", transfer), ("3.1]]}", ("0.5]]}" if cuts else "3.1]]}") + cuts))
    before, scale = momentum(s), (s.particles.mass * np.abs(s.particles.V)).sum()
    pressed = 0.0
    for _ in range(120):
        s.step()
        pressed = min(pressed, s.state.contact.force[0, 1])
    assert pressed < -20.0, "they have met"
    assert np.abs(momentum(s) - before).max() < 1e-13 * scale
    opening = s.cracks.chains[0].openings[0]
    assert opening.max() > 5e-4, "the crack opens"


@pytest.mark.slow
def test_a_body_in_two_halves_meets_another_as_two_bodies_do():
    """A crack right through the lower body, and two bodies in its place: the same contact with the upper one."""
    through = "[[0.0, -9], [0.0, -0.001]]}, ends: {start: mouth, end: mouth}, cuts: [low]"
    one = start(("[[0.2, -4.3], [0.2, 3.1]]}", through), ('"0.2*x", 3', '"0", 3'), ('"0.2*x", -3', '"0", -3'))
    left = "  - {name: low, material: m, region: {kind: box, lower: [-6, -8], upper: [0, 0]}, velocity: [0, 3]}\n"
    right = "  - {name: right, material: m, region: {kind: box, lower: [0, -8], upper: [6, 0]}, velocity: [0, 3]}\n"
    text = SCENE[: SCENE.index("cracks:")] + SCENE[SCENE.index("time:") :]
    old = SCENE[SCENE.index("  - {name: low") : SCENE.index("  - {name: high")]
    text = text.replace(old, left + right).replace('"0.2*x", -3', "0, -3")
    text = text.replace(
        "friction: 0.3}}", "friction: 0.3}, pairs: [{between: [low, right], law: {kind: frictionless}}]}"
    )
    both = one, Simulation(load_scene(text))
    at_start = [s.particles.X[:, np.argsort(s.particles.id)] for s in both]
    order = [np.lexsort(np.round(X, 9)) for X in at_start]
    pressed = np.zeros(2)
    for _ in range(40):
        for k, s in enumerate(both):
            s.step()
            pressed[k] = min(pressed[k], s.state.contact.force[:, 1].sum())
    a, b = (
        s.particles.V[:, np.argsort(s.particles.id)][:, rows] for s, rows in zip(both, order, strict=True)
    )
    assert pressed[0] == pytest.approx(pressed[1], rel=0.1)  # three bodies at a node are lumped
    assert np.sqrt(((a - b) ** 2).mean()) < 0.2 * np.sqrt((b**2).mean())


@pytest.mark.slow
def test_a_rigid_plate_presses_both_sides_of_a_crack():
    plate = "{name: high, material: r, region: {kind: box, lower: [-7, 0], upper: [7, 2]}, velocity: [0, -2]"
    old = '{name: high, material: m, region: {kind: box, lower: [-5, 0], upper: [5, 7]}, velocity: ["0.2*x", -3]'
    s = start(
        (old, plate),
        ("[0.2, -4.3], [0.2, 3.1]", "[0.2, -4.3], [0.2, 0.5]"),
        ("0.5]]}", "0.5]]}, ends: {end: mouth}"),
    )
    left = right = pressed = 0.0
    for _ in range(80):
        s.step()
        pressed = min(pressed, s.state.contact.force[0, 1])
        rows, grid = s.contact.contact_rows(), s.grid
        x = grid.coordinates(grid.node_of(rows.alpha[rows.touches]))[0]
        left, right = max(left, np.count_nonzero(x < 0.0)), max(right, np.count_nonzero(x > 1.0))
        beyond = grid.side_of(rows.alpha)
    assert left >= 5
    assert right >= 5
    assert beyond.max() == 1, "the plate meets the further side at nodes beside the crack"
    assert pressed < -20.0
    assert np.isfinite(s.particles.V).all()
