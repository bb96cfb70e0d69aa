"""Materials with axes in simulations: off-axis tension, a wooden ring and tube, waves, rotation (materials.md)."""

import math

import numpy as np
import pytest

from mpmcli.materials.axes import current_axis

WOOD = (
    "kind: orthotropic, density: 1, E1: 1, E2: 0.5, E3: 10, G12: 0.1, G13: 1, G23: 0.8, "
    "nu12: 0.6, nu13: 0.04, nu23: 0.03"
)
PLY = (
    "kind: transversely_isotropic, density: 1, E_axial: 10, E_transverse: 1, G_axial: 0.6, nu_axial: 0.3, "
    "nu_transverse: 0.4"
)

TENSION = """version: 1
analysis: {kind: plane_stress}
grid: {lower: [-1, -1], upper: [5, 3], cell: 0.5}
method: {shape: lcpdi, update: usl, transfer: {kind: fmpm, order: 2}, damping: {grid: 0.6}}
materials: {ply: {%s}}
bodies: [{name: bar, material: ply, axes: %g, region: {kind: box, lower: [0, 0], upper: [4, 2]}}]
loads:
  - {name: left, kind: traction, on: {body: bar, face: {axis: x, side: lower}}, traction: ["-1e-6*min(1, t/10)", 0]}
  - {name: right, kind: traction, on: {body: bar, face: {axis: x, side: upper}}, traction: ["1e-6*min(1, t/10)", 0]}
time: {end: 60, courant: 0.4}
"""


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0, 20, 45, 90])
def test_off_axis_tension(start, degrees):
    """1/E = c⁴/E₁ + s⁴/E₂ + c²s²(1/G₁₂ − 2ν₁₂/E₁); shear couples with it."""
    run = start(TENSION % (PLY, degrees))
    run.to(60)
    F = run.ordered("F")
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    exact = c**4 / 10 + s**4 + (c * s) ** 2 * (1 / 0.6 - 2 * 0.3 / 10)
    assert (F[0] - 1) / 1e-6 == pytest.approx(exact, rel=1e-3)
    shear = (2 / 10 + 2 * 0.3 / 10 - 1 / 0.6) * s * c**3 - (2 + 2 * 0.3 / 10 - 1 / 0.6) * s**3 * c
    assert (F[1] + F[2]) / 1e-6 == pytest.approx(shear, rel=1e-3, abs=1e-3)


def ring(r, a, b, Qrr, Qtt, Qrt, load, inner):
    """u, σ_r, σ_θ of Qrr(u″ + u′/r − k²u/r²) = −load·r, k² = Qtt/Qrr, σ_r(a) = −inner, σ_r(b) = 0 (Lekhnitskii)."""
    k = math.sqrt(Qtt / Qrr)
    part = -load / (Qrr * (9 - k * k))

    def stress(x, f, slope):
        return Qrr * slope + Qrt * f / x

    M = np.array([[stress(x, x**e, e * x ** (e - 1)) for e in (k, -k)] for x in (a, b)])
    rest = np.array([-inner, 0.0]) - [stress(x, part * x**3, 3 * part * x**2) for x in (a, b)]
    A, B = np.linalg.solve(M, rest)
    u = A * r**k + B * r**-k + part * r**3
    slope = k * (A * r ** (k - 1) - B * r ** (-k - 1)) + 3 * part * r**2
    return u, stress(r, u, slope), Qrt * slope + Qtt * u / r


@pytest.mark.slow
def test_spinning_ring_of_wood(start):
    """Radial and tangential axes from an expression of the place: displacement and σ_r of a cylindrical anisotropy."""
    run = start("wood_ring.yaml")
    run.to(60)
    R, angle = np.hypot(*run.X0), np.arctan2(run.X0[1], run.X0[0])
    n = np.stack([np.cos(angle), np.sin(angle)])
    nu21 = 0.6 * 0.5
    Qrr, Qtt, Qrt = 1 / (1 - 0.6 * nu21), 0.5 / (1 - 0.6 * nu21), nu21 / (1 - 0.6 * nu21)
    u, radial, tangential = ring(R, 1, 2, Qrr, Qtt, Qrt, 1e-5, 0)
    moved = ((run.X - run.X0) * n).sum(axis=0)
    assert np.abs(moved - u).max() < 0.025 * u.max()
    xx, yy, _, xy = run.stress
    found = xx * n[0] ** 2 + yy * n[1] ** 2 + 2 * xy * n[0] * n[1]
    inside, largest = (R > 1.2) & (R < 1.8), tangential.max()
    assert np.sqrt(np.mean((found - radial)[inside] ** 2)) < 0.025 * largest
    assert np.sqrt(np.mean((xx + yy - found - tangential)[inside] ** 2)) < 0.02 * largest


@pytest.mark.slow
def test_wooden_tube_under_pressure(start):
    """Axisymmetric: axes 1, 2, 3 are radial, axial and tangential; no axial strain."""
    wood = WOOD.replace("E2: 0.5, E3: 10", "E2: 10, E3: 0.5").replace(
        "nu12: 0.6, nu13: 0.04", "nu12: 0.04, nu13: 0.6"
    )
    wood = wood.replace("nu23: 0.03", "nu23: 0.6")
    run = start("axisymmetric_disk_pressure.yaml", f"materials.elastic={{{wood}}}", "time.end=40")
    run.to(40)
    S = np.array([[1, -0.04, -0.6], [-0.04, 0.1, -0.06], [-0.6, -0.06, 2.0]])
    C = np.linalg.inv(S)
    R = run.X0[0]
    u, radial, _ = ring(R, 1, 2, C[0, 0], C[2, 2], C[0, 2], 0, 1e-5)
    assert np.abs(run.X[0] - R - u).max() < 1e-3 * u.max()
    assert np.sqrt(np.mean((run.stress[0] - radial) ** 2)) < 0.03 * 1e-5


STRIP = """version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [20, 2], cell: 0.5}
method: {shape: lcpdi, transfer: {kind: flip}}
materials: {ply: {%s}}
bodies: [{name: strip, material: ply, axes: %g, region: {kind: box, lower: [0, 0], upper: [20, 2]}, velocity: %s}]
boundary: %s
time: {end: 1000, courant: 0.3}
"""
SIDES = """
  - {name: low, kind: symmetry, plane: {axis: y, at: 0}}
  - {name: high, kind: symmetry, plane: {axis: y, at: 2}}"""
ENDS = """
  - {name: left, kind: symmetry, plane: {axis: x, at: 0}}
  - {name: right, kind: symmetry, plane: {axis: x, at: 20}}"""


@pytest.mark.slow
@pytest.mark.parametrize(("degrees", "modulus"), [(0, "C11"), (90, "C22")])
def test_waves_along_and_across_the_fibres(start, degrees, modulus):
    """The first standing wave between walls returns after 2L/c, with c² = C/ρ."""
    run = start(STRIP % (PLY, degrees, '["1e-4*sin(pi*x/20)", 0]', SIDES + ENDS))
    C = getattr(run.simulation.state.material_models[0].stiffness, modulus)
    shape = np.sin(np.pi * run.X0[0] / 20)
    period = 40 / math.sqrt(C)
    t, y = np.array(run.to(2.2 * period, lambda r: (r.time, float((shape * r.V[0]).sum())))).T
    up = np.flatnonzero((y[:-1] < 0) & (y[1:] >= 0))
    zeros = t[up] - y[up] * (t[up + 1] - t[up]) / (y[up + 1] - y[up])
    assert zeros[1] - zeros[0] == pytest.approx(period, rel=5e-3)


@pytest.mark.slow
def test_a_spinning_block_keeps_its_energy(start):
    """More than a turn of an off-axis block in free rotation: the energy stays, and the fibres turn with it."""
    scene = f"""version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [-4, -4], upper: [4, 4], cell: 0.5}}
method: {{shape: lcpdi, update: usavg+, transfer: {{kind: flip}}}}
materials: {{ply: {{{PLY}}}}}
bodies:
  - name: block
    material: ply
    axes: 30
    region: {{kind: box, lower: [-2, -1], upper: [2, 1]}}
    velocity: ["-0.02*y", "0.02*x"]
time: {{end: 700, courant: 0.3}}
"""
    run = start(scene)
    state = run.simulation.state

    def energy(r):
        stored = float((r.particles.vol0 * state.strain_energy_density()).sum())
        return r.kinetic_energy + stored

    first = energy(run)
    seen = run.to(2 * 2 * math.pi / 0.02, energy)
    assert np.abs(np.array(seen) / first - 1).max() < 1e-3
    axis = np.empty_like(run.X)
    axis[:, run.particles.id] = current_axis(run.particles, run.simulation.state.material_models)[:2]
    turned = np.exp(1j * np.radians(30)) * (run.X[0] + 1j * run.X[1]) / (run.X0[0] + 1j * run.X0[1])
    assert np.abs(np.angle(np.mean((axis[0] + 1j * axis[1]) / turned))) < math.radians(0.5)
