"""Solids that damping brings to rest under loads: a cantilever, a column under its weight, a plate with a hole."""

import numpy as np
import pytest

SLOW = pytest.mark.slow


@pytest.mark.slow
@pytest.mark.parametrize(("cell", "tolerance"), [(0.5, 0.03), (0.25, 0.012)])
def test_cantilever_with_a_load_at_its_tip(start, cell, tolerance):
    """PL³/3EI, and PL/κGA of shear (κ = 5/6: Timoshenko); bending stress and shear force along the beam."""
    run = start("cantilever_tip_load.yaml", f"grid.cell={cell}")
    run.to(45)
    P, L, inertia, G = 0.01, 10.0, 1 / 12, 1000 / 2.6
    X, Y = run.X0
    tip = X > X.max() - 1e-9
    x = X[tip][0]
    deflection = P * x**2 * (3 * L - x) / (6 * 1000 * inertia) + P * x / (5 / 6 * G)
    assert (run.X - run.X0)[1][tip].mean() == pytest.approx(-deflection, rel=tolerance)
    middle = (X > 1) & (X < 9)
    bending = (P * (L - X) * Y / inertia)[middle]
    error = run.stress[0][middle] - bending
    assert np.sqrt(np.mean(error**2)) < tolerance * np.abs(bending).max()
    assert run.stress[3][middle].mean() == pytest.approx(-P, rel=1e-3)


def column_error(run):
    """Root mean square of σ_yy + ρ₀ g (H − Y) over its largest value."""
    exact = -0.02 * (20 - run.X0[1])
    return np.sqrt(np.mean((run.stress[1] - exact) ** 2)) / 0.4


COLUMNS = [  # what is changed, root mean square error of the stress over its largest value
    ((), 0.002),
    (("bodies.column.particles_per_axis=1",), 0.0005),
    (("bodies.column.particles_per_axis=3",), 0.002),
    pytest.param(("grid.cell=0.25",), 0.0008, marks=SLOW),
    pytest.param(("method.shape=ugimp",), 0.03, marks=SLOW),
    pytest.param(("method.shape=bspline2",), 0.025, marks=SLOW),
    pytest.param(("method.shape=b2gimp",), 0.006, marks=SLOW),
    pytest.param(("method.shape=b2cpdi",), 0.001, marks=SLOW),
]


@pytest.mark.parametrize(("sets", "tolerance"), COLUMNS)
def test_column_under_gravity(start, sets, tolerance):
    """σ_yy = −ρ₀ g (H − Y) with the initial height Y at any strain: here J goes down to 0.75, by 5 cells at the top."""
    run = start("column_under_gravity.yaml", *sets)
    run.to(200)
    assert run.J.min() < 0.76
    assert np.abs(run.V).max() < 1e-5
    assert column_error(run) < tolerance
    assert run.simulation.state.reactions["floor"][1] == pytest.approx(0.02 * 20 * 2, rel=1e-4)


@pytest.mark.parametrize("transfer", ["{kind: flip}", "{kind: fmpm, order: 4}"])
def test_weight_at_once_doubles_the_weight(start, transfer):
    """Without damping the column swings between zero and twice its weight, with the period 4H/c."""
    g, c = 5e-4, np.sqrt(0.7 / (1.3 * 0.4))
    period, sinking = 80 / c, -g * 20**2 / c**2
    sets = (f"constants.g={g}", "constants.rise=0.001", "method.damping={}", f"method.transfer={transfer}")
    run = start("column_under_gravity.yaml", *sets)
    top = run.X0[1] > 19.7
    seen = run.to(
        period, lambda r: (r.time, r.simulation.state.reactions["floor"][1], (r.X - r.X0)[1][top].mean())
    )
    t, floor, sunk = np.array(seen).T
    floor /= g * 20 * 2
    assert sunk.min() == pytest.approx(sinking, rel=0.01)
    near = np.abs(t - t[np.argmin(sunk)]) < 0.05 * period
    a, b, _ = np.polyfit(t[near], sunk[near], 2)
    assert -b / (2 * a) == pytest.approx(period / 2, rel=0.005)
    rising = (t > 0.03 * period) & (t < 0.45 * period)
    assert np.sqrt(np.mean((floor - 4 * t / period)[rising] ** 2)) < 0.02
    assert floor[np.abs(t / period - 0.5) < 0.03].mean() == pytest.approx(2 * (1 - 0.03), rel=0.01)
    assert sunk[-1] == pytest.approx(0, abs=0.005 * abs(sinking))
    assert np.abs(run.V).max() < 0.05 * g * 20 / c


def kirsch(x, y):
    """σ_xx, σ_yy, σ_xy around a hole of radius 1 in an infinite plate pulled by 1 along x (Kirsch 1898)."""
    r2 = x**2 + y**2
    c2, s2 = (x**2 - y**2) / r2, 2 * x * y / r2
    c4, s4 = 2 * c2**2 - 1, 2 * s2 * c2
    return np.array(
        [
            1 - (1.5 * c2 + c4) / r2 + 1.5 * c4 / r2**2,
            -(0.5 * c2 - c4) / r2 - 1.5 * c4 / r2**2,
            -(0.5 * s2 + s4) / r2 + 1.5 * s4 / r2**2,
        ]
    )


def exact_tractions():
    """The stress of ``kirsch`` as expressions of a scene, on the two outer edges."""
    r2 = "(x*x + y*y)"
    c2, s2 = f"((x*x - y*y)/{r2})", f"(2*x*y/{r2})"
    c4, s4 = f"(2*{c2}**2 - 1)", f"(2*{s2}*{c2})"
    xx = f"1 - (1.5*{c2} + {c4})/{r2} + 1.5*{c4}/{r2}**2"
    yy = f"-(0.5*{c2} - {c4})/{r2} - 1.5*{c4}/{r2}**2"
    xy = f"-(0.5*{s2} + {s4})/{r2} + 1.5*{s4}/{r2}**2"
    loads = (
        f"{{name: {axis}, kind: traction, on: {{body: plate, face: {{axis: {axis}, side: upper}}}},"
        f" traction: ['s*min(1, t/rise)*({first})', 's*min(1, t/rise)*({second})']}}"
        for axis, first, second in (("x", xx, xy), ("y", xy, yy))
    )
    return f"loads=[{', '.join(loads)}]"


def concentration(run):
    """Three times the mean of σ_xx over its value in an infinite plate, on the line above the hole up to 2 a."""
    x, y = run.X0
    line = (x < run.simulation.grid.cell[0]) & (y < 2)
    heights, row = np.unique(y[line], return_inverse=True)
    stress = np.bincount(row, run.stress[0][line] / 1e-5) / np.bincount(row)
    return 3 * np.mean(stress / kirsch(0.0, heights)[0])


PLATES = [  # cell, shape, particles per axis; bounds of the error within 1.5 a and beyond
    pytest.param(0.125, "lcpdi", 2, 0.1, 0.008, marks=SLOW),
    pytest.param(0.25, "lcpdi", 2, 0.15, 0.017, marks=SLOW),
    pytest.param(0.0625, "lcpdi", 2, 0.1, 0.004, marks=SLOW),
    pytest.param(0.125, "lcpdi", 4, 0.07, 0.008, marks=SLOW),
    pytest.param(0.125, "b2cpdi", 2, 0.09, 0.005, marks=SLOW),
]


@pytest.mark.parametrize(("cell", "shape", "per_axis", "near", "far"), PLATES)
def test_plate_with_a_hole_under_exact_tractions(start, cell, shape, per_axis, near, far):
    """4 a wide, with the stress of the infinite plate as tractions: no correction for a finite width is needed."""
    run = start(
        "kirsch_plate.yaml", "constants.width=4", "constants.length=4", "constants.rise=15", exact_tractions(),
        f"grid.cell={cell}", f"method.shape={shape}", "method.damping={grid: 0.4}",
        f"bodies.plate.particles_per_axis={per_axis}", "time.end=60",
    )  # fmt: skip
    run.to(60)
    error = run.stress[[0, 1, 3]] / 1e-5 - kirsch(*run.X0)
    beyond = np.hypot(*run.X0) > 1.5
    print("rms within, beyond", *(np.sqrt(np.mean(error[:, m] ** 2)) for m in (~beyond, beyond)), end=" ")
    print("concentration", concentration(run), "largest", run.stress[0].max() / 1e-5)
    assert np.sqrt(np.mean(error[:, ~beyond] ** 2)) < near
    assert np.sqrt(np.mean(error[:, beyond] ** 2)) < far
    assert concentration(run) == pytest.approx(3, rel=0.01)


@pytest.mark.slow
def test_plate_with_a_hole(start):
    """A hole a fifth as wide as a long plate: 3.15 times the stress at the ends (fit of Howland's figures)."""
    run = start("kirsch_plate.yaml")
    run.to(80)
    narrow = 1 - 1 / 5
    howland = 0.284 + 2 / narrow - 0.6 * narrow + 1.32 * narrow**2
    assert howland == pytest.approx(3.149, abs=1e-3)
    assert concentration(run) == pytest.approx(howland, rel=0.015)
    assert np.abs(run.stress[0][run.X0[0] > 9.9] / 1e-5 - 1).max() < 0.002
