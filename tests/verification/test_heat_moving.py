"""Temperatures that a body carries over the grid: what transfers keep of them, resting and translating."""

import exact_heat as exact
import numpy as np
import pytest
from heat_runs import heat, scaled, table, transfer

SLOW = pytest.mark.slow
METHODS = ("FLIP", "FLIP(4)", "FMPM(1)", "FMPM(2)", "FMPM(4)", "FMPM(8)")
BAR = {
    (row["method"], int(row["FMPM every"]), float(row["D dt/dx^2"]), float(row["cells moved"])): row
    for row in table("moving_bar")
}
DISK = {
    (row["method"], int(row["FMPM every"]), float(row["D dt/dx^2"]), float(row["cells moved"])): row
    for row in table("nairnmpm_disk")
}


def bar(start, method, s, moved, every=1, *sets):
    """What is left of the cosine, in the temperature that is seen and in the one that is carried."""
    run = start(
        "heat_flying_bar.yaml", f"constants.s={s}", f"constants.moved={moved}", transfer(method, every), *sets
    )
    mode, before = np.cos(np.pi * run.X0[0] / 20), heat(run)
    run.to(40)
    assert np.abs(run.X[0] - run.X0[0] - moved).max() < 1e-10
    assert abs(heat(run) / before - 1) < 1e-12
    return exact.amplitude(scaled(run), mode), exact.amplitude(scaled(run, "T_carried"), mode)


def check(found, row):
    assert found == pytest.approx((float(row["amplitude seen"]), float(row["amplitude"])), abs=5e-4)


@pytest.mark.parametrize(
    ("method", "s", "moved"),
    [
        ("FLIP", 0.25, 10),
        ("FMPM(4)", 0.25, 10),
        ("FMPM(1)", 0.25, 10),
        *(pytest.param(m, s, v, marks=SLOW) for m in METHODS for s in (0.25, 0.025, 0.0025) for v in (0, 10)),
    ],
)
def test_amplitude_of_the_bar_is_that_of_an_independent_code(start, method, s, moved):
    check(bar(start, method, s, moved), BAR[method, 1, s, moved])


@pytest.mark.slow
@pytest.mark.parametrize("method", ["FMPM(2)", "FMPM(4)", "FMPM(8)"])
@pytest.mark.parametrize("s", [0.25, 0.025, 0.0025])
@pytest.mark.parametrize("moved", [0, 10])
def test_fmpm_on_every_tenth_step(start, method, s, moved):
    check(bar(start, method, s, moved, 10), BAR[method, 10, s, moved])


@pytest.mark.slow
def test_an_interval_gives_what_long_steps_give(start):
    every_tenth = bar(start, "FLIP", 0.0025, 10, 1, "heat.interval=10")
    assert every_tenth == pytest.approx(bar(start, "FLIP", 0.025, 10), abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)", "FMPM(8)"])
def test_the_second_mode_of_a_bar_of_point_particles(start, method):
    """16 cells, 7.3 cells of translation: the same as at rest within the error of the grid."""
    sets = ("method.shape=linear", "constants.L=16", "bodies.bar.temperature='300 + 100*cos(2*pi*x/L)'")
    left = []
    for moved in (0, 7.3):
        run = start(
            "heat_flying_bar.yaml", "constants.s=0.1", f"constants.moved={moved}", transfer(method), *sets
        )
        mode = np.cos(2 * np.pi * run.X0[0] / 16)
        run.to(0.1 * 16**2)
        left.append(exact.amplitude(scaled(run), mode))
    wanted = exact.mode_amplitude(2 * np.pi, 0.1)
    assert np.abs(np.array(left) / wanted - 1).max() < (0.12 if method == "FLIP" else 0.03)
    assert abs(left[0] - left[1]) < 5e-4


def disk(start, method, s, moved, every=1):
    """What is left of the mode of the disk in the temperature that is carried, and in the one that is seen."""
    run = start(
        "heat_flying_disk.yaml", f"constants.s={s}", f"constants.moved={moved}", transfer(method, every)
    )
    x, y = run.X0 / 8.0
    mode, before = exact.disk_mode(x, y), heat(run)
    assert exact.amplitude(scaled(run, "T_carried"), mode) == pytest.approx(1.0, abs=1e-9)
    run.to(128)
    assert abs(heat(run) / before - 1) < 1e-12
    return exact.amplitude(scaled(run, "T_carried"), mode), exact.amplitude(scaled(run), mode)


@pytest.mark.slow
@pytest.mark.parametrize("key", DISK, ids=lambda key: "-".join(map(str, key)))
def test_amplitude_of_the_disk_is_that_of_nairnmpm(start, key):
    method, every, s, moved = key
    carried, seen = disk(start, method, s, moved, every)
    assert carried == pytest.approx(float(DISK[key]["amplitude"]), abs=1e-3)
    assert abs(seen - carried) < 0.006


WAVES = """
version: 1
constants: {{cells: {cells}, length: {length}}}
analysis: {{kind: uniaxial_strain}}
grid: {{lower: [0], upper: ["length"], cell: 1}}
method: {{shape: {shape}, transfer: {{kind: flip}}}}
heat: {{transfer: {{kind: fmpm, order: {order}}}}}
materials:
  m: {{kind: linear_elastic, density: 1, E: 1, nu: 0, heat_capacity: 1, conductivity: 1e-20, T0: 300}}
bodies:
  - name: bar
    material: m
    region: {{kind: box, lower: [0], upper: ["length"]}}
    temperature: "300 + 100*cos(2*pi*x/cells)"
boundary:
  - {{name: left, kind: symmetry, plane: {{axis: x, at: 0}}}}
  - {{name: right, kind: symmetry, plane: {{axis: x, at: "length"}}}}
time: {{end: 1000, step: 0.1}}
"""


@pytest.mark.parametrize(
    ("shape", "loss"),
    [
        ("ugimp", exact.hat_loss),
        *(
            pytest.param(s, loss, marks=SLOW)
            for s, loss in (("linear", exact.hat_loss), ("b2gimp", exact.spline_loss))
        ),
    ],
)
def test_a_step_of_fmpm_filters_waves_as_the_formula_says(start, shape, loss):
    """(1 − a^k)^N of a wave is left after N steps without conduction; ``loss`` is a."""
    for cells, length in ((4, 8), (8, 16), (16, 16), (40, 40)):
        for order in (1, 2, 4, 8):
            run = start(WAVES.format(cells=cells, length=length, shape=shape, order=order))
            mode = np.cos(2 * np.pi * run.X0[0] / cells)
            run.simulation.step()
            first = exact.amplitude(scaled(run), mode)
            for _ in range(20):
                run.simulation.step()
            left = exact.amplitude(scaled(run), mode) / first
            assert left == pytest.approx(exact.filtered(loss(cells), order, 20), abs=1e-6)
