"""Growth to the end of matter, with real particles: into a free edge, another crack, along the border of a body."""

import numpy as np
import pytest
from crack_runs import chain

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]

PLATE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-11, -11], upper: [11, 11], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials: {elastic: {kind: linear_elastic, E: 1000, nu: 0.33, density: 0.001}}
bodies:
  - {name: plate, material: elastic, region: {kind: box, lower: [-8, -8], upper: [8, 8]}, velocity: ["0", "0.5*y"]}
cracks: CRACKS
fracture: {inner: 1, outer: 2, every: 1.0e-4}
time: {end: 1, courant: 0.3}
"""
GROWS = "growth: {end: {criterion: {kind: steady_speed, speed: 400}, increment: 0.5}}"
EDGE = f"{{name: main, path: {{kind: points, points: [[-9, 0.3], [2.2, 0.3]]}}, ends: {{start: mouth}}, {GROWS}}}"
OTHER = "{name: other, path: {kind: points, points: [[5.2, -3.4], [5.4, 3.1]]}}"
BORDER = (
    "{name: main, path: {kind: points, points: [[-9, HEIGHT], [-2.1, HEIGHT]]}, ends: {start: mouth},"
    " growth: {end: {criterion: {kind: steady_speed, speed: 400}, direction: {kind: initial}, increment: 0.5}}}"
)


def grown(start, cracks, end):
    """A run of a plate with these cracks, whose momentum is kept, and the events of the first one."""
    run = start(PLATE.replace("CRACKS", f"[{cracks}]"))
    scale = float((run.mass * np.abs(run.V).max(axis=0)).sum())
    before = (run.mass * run.V).sum(axis=1)
    run.to(end)
    assert np.isfinite(run.V).all()
    assert np.abs((run.mass * run.V).sum(axis=1) - before).max() < 1e-11 * scale
    return run, [event[3] for event in run.simulation.cracks.view.events if event[1] == "main"]


def test_into_a_free_edge(start):
    """The tip becomes a mouth once; then the plate is two pieces, which meet in contact alone."""
    run, events = grown(start, EDGE, 0.05)
    assert events.count("mouth") == 1
    assert events[-1] == "mouth"
    assert chain(run).X[0, -1] > 7.9
    upper, s = run.X0[1] > 0.3, run.simulation
    momentum = (run.mass * run.V)[:, upper].sum(axis=1)
    impulses = run.to(0.1, lambda run: s.state.dt * s.cracks.view.force[0])
    change = (run.mass * run.V)[:, upper].sum(axis=1) - momentum
    scale = float((run.mass * np.abs(run.V).max(axis=0)).sum())
    assert change == pytest.approx(np.sum(impulses, axis=0), abs=1e-11 * scale)


def test_into_another_crack(start):
    """It joins the other crack and stops there."""
    run, events = grown(start, f"{EDGE}, {OTHER}", 0.05)
    assert events.count("joined") == 1
    assert events[-1] == "joined"
    main, other = chain(run, 0), chain(run, 1)
    away = np.hypot(*(other.X - main.X[:, -1:])).min()
    assert away < 0.5
    assert main.joined[1]


@pytest.mark.parametrize("height", [7.6, 7.9])
def test_along_the_border_of_a_body(start, height):
    """Less than a cell beside the edge, where a row of particles is peeled off."""
    _, events = grown(start, BORDER.replace("HEIGHT", str(height)), 0.05)
    assert events[-1] == "mouth"
    assert set(events) == {"growth", "mouth"}
