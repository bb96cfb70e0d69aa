"""Bodies that move or oscillate at a large share of the wave speed: perturbations grow far below the usual limits."""

import math
from pathlib import Path

import pytest

from mpmcli.stability.growth import FAST_GROWTH
from mpmcli.study.trial import run_trial

pytestmark = pytest.mark.slow

SCENE = """
version: 1
analysis: {{kind: uniaxial_stress, area: 1}}
grid: {{lower: [-5], upper: [{end}], cell: 1}}
method: {{shape: {shape}, update: usl, transfer: {transfer}}}
materials:
  elastic: {{kind: linear_elastic, density: 1, E: 1, nu: 0}}
bodies:
  - {{name: bar, material: elastic, region: {{kind: box, lower: [0], upper: [60]}}, velocity: [{speed}]}}
time: {{end: 300, courant: 0.2}}
archive: {{particles: {{every: 300, fields: [velocity]}}, globals: {{every: 100}}}}
"""


def growth(tmp_path, courant, **what):
    """Growth per step, of the logarithm of a disturbance in flight."""
    in_run, steps = grown(tmp_path, courant, **what)
    return in_run / steps


def grown(tmp_path, courant, speed=0.4, shape="lcpdi", transfer="{kind: fmpm, order: 4}"):
    """Growth of the logarithm of a disturbance in the whole flight, and the number of its steps."""
    path = tmp_path / "flight.yaml"
    end = math.ceil(300 * speed + 80)
    path.write_text(SCENE.format(end=end, shape=shape, transfer=transfer, speed=speed))
    job = {"scene": str(path), "courant": courant, "bound": 0.05, "threads": 1, "is_disturbed": True}
    found = run_trial(job)
    assert found["ended"] == "finished"
    return math.log(found["growth"]), found["steps"]


def test_perturbations_grow_in_fast_motion(tmp_path):
    assert growth(tmp_path, 0.45) > 3.0 * FAST_GROWTH
    assert growth(tmp_path, 0.45, speed=0.05) < 0.2 * FAST_GROWTH
    assert growth(tmp_path, 0.45, transfer="{kind: flip}") < 0.2 * FAST_GROWTH


@pytest.mark.parametrize(("speed", "order"), [(0.2, 4), (0.4, 4), (0.8, 4), (0.4, 8), (0.4, 2)])
def test_auto_lets_little_grow(tmp_path, speed, order):
    in_run, steps = grown(tmp_path, "auto", speed, transfer=f"{{kind: fmpm, order: {order}}}")
    assert in_run < FAST_GROWTH * steps


INPUTS = Path(__file__).parents[2] / "inputs"


def trial(scene, courant, *sets):
    job = {"scene": str(INPUTS / f"{scene}.yaml"), "sets": sets, "courant": courant}
    return run_trial(job | {"bound": 0.05, "threads": 1, "is_disturbed": True})


@pytest.mark.parametrize("v0", [0.05, 0.2, 0.22, 0.3, 0.5])
@pytest.mark.parametrize("order", [2, 4, 8])
def test_auto_is_stable_however_far_a_bar_oscillates(v0, order):
    """The end turns amid a cell with v0 = 0.05 and 0.2, and is fast with 0.22 to 0.5, of a wave speed of 2."""
    sets = [f"constants.v0={v0}", f"method.transfer={{kind: fmpm, order: {order}}}", "grid.upper=[70]"]
    found = trial("vibrating_bar", "auto", *sets)
    assert found["ended"] == "finished"
    assert found["growth"] < 100.0


def test_nothing_grows_at_the_rim_of_a_moving_disk_with_auto():
    sets = ["bodies.right.velocity=[0, 0]", "time.end=0.04"]  # before they meet
    quiet, loud = trial("two_disks", "auto", *sets), trial("two_disks", 0.45, *sets)
    assert quiet["growth"] < 1.0
    assert loud["bounded"]
    assert loud["growth"] > 100.0


def test_auto_is_stable_in_a_bar_whose_ends_are_faster_than_waves():
    grid = ["grid.lower=[-25, -3]", "grid.upper=[25, 3]", "time.end=8"]
    found = trial("stretched_bar", "auto", *grid)
    assert found["ended"] == "finished"
    assert found["growth"] < 10.0
    assert not trial("stretched_bar", 0.5, *grid)["bounded"]
