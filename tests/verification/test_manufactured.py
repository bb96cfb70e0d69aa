"""Manufactured solutions: known large motions, the body forces that cause them, and the order of convergence."""

import numpy as np
import pytest

MATERIAL = "{kind: neo_hookean, density: 1, E: 1, nu: %g, volumetric: log}"


def order(sizes, errors) -> float:
    """Slope of log error over log cell size."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def largest_error(run, end, exact) -> float:
    """Largest over the steps of the root mean square of the displacement error."""

    def error(r):
        return float(np.sqrt(np.square(r.X - r.X0 - exact(*r.X0, r.time)).sum(axis=0).mean()))

    return max(run.to(end, error))


def axis_aligned(start, cells, A, transfer, update="usavg"):
    """u_x = A sin(πX) sin(cπt), u_y = A sin(πY) sin(cπt + π) in the unit square (Wallstedt & Guilkey 2008)."""
    lame, mu = 0.3 / (1.3 * 0.4), 0.5 / 1.3
    fx = f"(1 + pi*{A}*cos(pi*x)*sin(pi*t))"
    fy = f"(1 - pi*{A}*cos(pi*y)*sin(pi*t))"
    bracket = "pi*pi*{A}*{u}*sin(pi*t)*({lame}/{f}**2*(1 - log({fx}*{fy})) + {mu}*(1 + 1/{f}**2) - 1)"
    words = {"A": A, "lame": lame, "mu": mu, "fx": fx, "fy": fy}
    bx = bracket.format(u="sin(pi*x)", f=fx, **words)
    by = bracket.format(u="(-sin(pi*y))", f=fy, **words)
    run = start(
        f"""
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [1, 1], cell: {1 / cells}}}
method: {{shape: lcpdi, update: {update}, transfer: {transfer}}}
materials: {{m: {MATERIAL % 0.3}}}
bodies:
  - name: square
    material: m
    region: {{kind: box, lower: [0, 0], upper: [1, 1]}}
    velocity: ["pi*{A}*sin(pi*x)", "-pi*{A}*sin(pi*y)"]
boundary:
  - {{name: left, kind: symmetry, plane: {{axis: x, at: 0}}}}
  - {{name: right, kind: symmetry, plane: {{axis: x, at: 1}}}}
  - {{name: bottom, kind: symmetry, plane: {{axis: y, at: 0}}}}
  - {{name: top, kind: symmetry, plane: {{axis: y, at: 1}}}}
loads: [{{name: source, kind: body_force, acceleration: ["{bx}", "{by}"], coordinates: initial}}]
time: {{end: 1, courant: 0.2}}
"""
    )
    S = np.sin

    def exact(X, Y, t):
        return np.array([A * S(np.pi * X) * S(np.pi * t), -A * S(np.pi * Y) * S(np.pi * t)])

    return largest_error(run, 1.0, exact) / A


def vortex(start, cells, amplitude, transfer):
    """A ring whose circles turn by α = g(t) h(R), each rigidly (Kamojjala et al. 2015)."""
    mu = 0.5 / 1.3
    r = "sqrt(x*x + y*y)"
    h = f"(1 - 32*({r} - 1)**2 + 256*({r} - 1)**4)"
    h1 = f"(-64*({r} - 1) + 1024*({r} - 1)**3)"
    h2 = f"(-64 + 3072*({r} - 1)**2)"
    g, g1 = f"({amplitude}*sin(pi*t))", f"({amplitude}*pi*cos(pi*t))"
    radial = f"{r}*({mu}*({g}*{h1})**2 - ({g1}*{h})**2)"
    hoop = f"(-{r}*pi*pi*{g}*{h} - {mu}*(3*{g}*{h1} + {r}*{g}*{h2}))"
    turned = f"(atan2(y, x) + {g}*{h})"
    bx = f"{radial}*cos{turned} - {hoop}*sin{turned}"
    by = f"{radial}*sin{turned} + {hoop}*cos{turned}"
    run = start(
        f"""
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [-1.5, -1.5], upper: [1.5, 1.5], cell: {1 / cells}}}
method: {{shape: lcpdi, transfer: {transfer}}}
materials: {{m: {MATERIAL % 0.3}}}
bodies:
  - name: ring
    material: m
    region: {{kind: disk, center: [0, 0], radius: 1.25, inner_radius: 0.75}}
    velocity: ["-y*{amplitude}*pi*{h}", "x*{amplitude}*pi*{h}"]
loads: [{{name: source, kind: body_force, acceleration: ["{bx}", "{by}"], coordinates: initial}}]
time: {{end: 1, courant: 0.2}}
"""
    )

    def exact(X, Y, t):
        R, angle = np.hypot(X, Y), np.arctan2(Y, X)
        angle = angle + amplitude * np.sin(np.pi * t) * (1 - 32 * (R - 1) ** 2 + 256 * (R - 1) ** 4)
        return np.array([R * np.cos(angle) - X, R * np.sin(angle) - Y])

    return largest_error(run, 1.0, exact) / amplitude


def expanding_ring(start, cells, A, transfer, update="usavg"):
    """u(R) = A sin(πt)(c₃R³ + c₂R² + c₁R) with both rims free, a quarter between symmetry planes; also |u_x − u_y|."""
    inner, outer = 0.4, 0.6
    D = outer - 3 * inner
    c3, c2 = -2 / (outer**2 * D), 3 * (inner + outer) / (outer**2 * D)
    c1 = -6 * inner / (outer * D)
    r, S = "sqrt(x*x + y*y)", f"({A}*sin(pi*t))"
    u = f"({c3}*{r}**3 + {c2}*{r}**2 + {c1}*{r})"
    fr = f"(1 + {S}*({3 * c3}*{r}**2 + {2 * c2}*{r} + {c1}))"
    ft = f"(1 + {S}*{u}/{r})"
    u2 = f"({S}*({6 * c3}*{r} + {2 * c2}))"
    stress = f"(0.5*(1 + 1/{fr}**2)*{u2} + 0.5*({fr} - 1/{fr} - {ft} + 1/{ft})/{r})"
    b = f"(-pi*pi*{S}*{u} - {stress})"
    run = start(
        f"""
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [0.8, 0.8], cell: {1 / cells}}}
method: {{shape: lcpdi, update: {update}, transfer: {transfer}}}
materials: {{m: {MATERIAL % 0}}}
bodies:
  - name: ring
    material: m
    region:
      kind: intersection
      regions:
        - {{kind: disk, center: [0, 0], radius: {outer}, inner_radius: {inner}}}
        - {{kind: box, lower: [0, 0], upper: [1, 1]}}
    velocity: ["pi*{A}*{u}*x/{r}", "pi*{A}*{u}*y/{r}"]
boundary:
  - {{name: left, kind: symmetry, plane: {{axis: x, at: 0}}}}
  - {{name: bottom, kind: symmetry, plane: {{axis: y, at: 0}}}}
loads: [{{name: source, kind: body_force, acceleration: ["{b}*x/{r}", "{b}*y/{r}"], coordinates: initial}}]
time: {{end: 1, courant: 0.2}}
"""
    )

    def exact(X, Y, t):
        R = np.hypot(X, Y)
        moved = A * np.sin(np.pi * t) * (c3 * R**3 + c2 * R**2 + c1 * R) / R
        return np.array([moved * X, moved * Y])

    error = largest_error(run, 1.0, exact) / A
    mirrored = np.lexsort((run.X0[0], run.X0[1])), np.lexsort((run.X0[1], run.X0[0]))
    asymmetry = np.abs(run.X[:, mirrored[0]] - run.X[::-1, mirrored[1]]).max()
    return error, asymmetry


FLIP, FMPM = "{kind: flip}", "{kind: fmpm, order: 4}"
SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("transfer", "update", "A", "cells", "least"),
    [
        (FMPM, "usavg", 0.05, (8, 16), 1.3),
        pytest.param(FMPM, "usavg", 1e-4, (8, 16, 32), 1.5, marks=SLOW),
        pytest.param(FMPM, "usavg", 0.05, (8, 16, 32), 1.2, marks=SLOW),
        pytest.param(FLIP, "usavg", 0.05, (8, 16, 32), 1.6, marks=SLOW),
        pytest.param(FMPM, "usl", 1e-4, (8, 16, 32), 0.6, marks=SLOW),
        pytest.param(FMPM, "usl", 0.05, (8, 16, 32), 0.8, marks=SLOW),
    ],
)
def test_axis_aligned_motion(start, transfer, update, A, cells, least):
    """usavg: between first and second order; usl starts half a step off in time: first order at a fixed C."""
    errors = [axis_aligned(start, n, A, transfer, update) for n in cells]
    print("axis aligned", transfer, update, A, errors, order([1 / n for n in cells], errors))
    assert order([1 / n for n in cells], errors) > least


@pytest.mark.parametrize(
    ("transfer", "amplitude", "cells", "least"),
    [
        (FMPM, 0.1, (8, 14), 1.7),
        pytest.param(FLIP, 0.1, (8, 16, 32), 1.7, marks=SLOW),
        pytest.param(FMPM, 0.1, (8, 16, 32), 1.7, marks=SLOW),
        pytest.param(FMPM, 0.5, (16, 32), 1.7, marks=SLOW),
    ],
)
def test_generalized_vortex(start, transfer, amplitude, cells, least):
    errors = [vortex(start, n, amplitude, transfer) for n in cells]
    print("vortex", transfer, amplitude, errors, order([1 / n for n in cells], errors))
    assert order([1 / n for n in cells], errors) > least


@pytest.mark.parametrize(
    ("transfer", "update", "cells", "least"),
    [
        (FMPM, "usl", (20, 40), 0.8),
        pytest.param(FMPM, "usl", (20, 40, 80), 0.8, marks=SLOW),
        pytest.param(FLIP, "usl", (20, 40, 80), 0.8, marks=SLOW),
        pytest.param(FMPM, "usavg", (20, 40, 80), 0.8, marks=SLOW),
    ],
)
def test_expanding_ring(start, transfer, update, cells, least):
    """Rims between grid lines; the quarter ring stays symmetric about its diagonal to round-off."""
    found = [expanding_ring(start, n, 0.02, transfer, update) for n in cells]
    errors = [error for error, _ in found]
    print("ring", transfer, update, found, order([1 / n for n in cells], errors))
    assert order([1 / n for n in cells], errors) > least
    assert max(asymmetry for _, asymmetry in found) < 1e-9
