"""Small scenes of inputs/ with exact answers, each of a material, condition or load that no other scene shows."""

import math
from pathlib import Path

import material_elements
import numpy as np
import pytest
from commands import spoken

from mpmcli.results.reading import Results

pytestmark = pytest.mark.slow
INPUTS = Path(__file__).parents[2] / "inputs"


@pytest.fixture
def finished(tmp_path):
    """Function (scene, *options) → results of the run."""

    def run(name: str, *options: str) -> Results:
        folder = tmp_path / name
        command = ["run", str(INPUTS / f"{name}.yaml"), "-o", str(folder), "-q", *options]
        code, written, _ = spoken(command)
        assert code == 0, written
        return Results(folder)

    return run


def of(results: Results, name: str, component: str, time: float | None = None) -> np.ndarray:
    """A component of all particles, at the end by default."""
    frame = results.particles() if time is None else results.particles(time)
    return frame[name][:, frame.components[name].index(component)]


def volumes(results: Results) -> np.ndarray:
    """det F of all particles at the end."""
    return np.linalg.det(results.particles()["deformation_gradient"].reshape(-1, 3, 3))


SAND = (
    "materials.soil={kind: drucker_prager, match: outer, density: 1600, E: 20 MPa, nu: 0.3, cohesion: 1 kPa, "
    "friction: 30, dilation: 10}"
)


def test_sand_in_a_triaxial_test(finished):
    """Kirchhoff stresses at failure: tan²(45° + φ/2) times the lateral one, and 2c tan(45° + φ/2)."""
    results = finished("triaxial_test", "--set", SAND)
    J = volumes(results)
    lateral, axial = (-np.mean(J * of(results, "stress", c)) for c in ("XX", "YY"))
    assert lateral / J.mean() == pytest.approx(1e5, rel=0.02)
    assert axial == pytest.approx(3 * lateral + 2e3 * math.sqrt(3), rel=0.01)
    assert abs(results["energy_error"]).max() < 0.05


def test_clay_in_a_triaxial_test(finished):
    """Drained: the change of volume is that of the pressures p and p + q²/(M²p) on the two slopes."""
    results = finished("triaxial_test")
    J = volumes(results)
    lateral, axial = (-np.mean(J * of(results, "stress", c)) for c in ("XX", "YY"))
    assert lateral / J.mean() == pytest.approx(1e5, rel=0.02)
    p, q = (2 * lateral + axial) / 3, axial - lateral
    consolidation = p + q * q / (1.2**2 * p)
    volume = (0.04 * math.log(p / 1e5) + 0.16 * math.log(consolidation / 1e5)) / 2
    assert -np.log(J).mean() == pytest.approx(volume, rel=0.02)
    assert q > 0.9e5


def test_a_paste_in_a_channel(finished):
    """u = (weight/2μ)(b² − (b − y)²) up to b = H − rest/weight, and constant above it."""
    results = finished("bingham_channel")
    y, u = results.particles().X[:, 1], of(results, "velocity", "X")
    b = 0.6
    exact = 2.5 * (b**2 - np.maximum(b - y, 0) ** 2)
    assert np.abs(u - exact).max() < 0.03 * exact.max()
    assert u[y > 0.7] == pytest.approx(0.9, rel=0.02)


def test_a_pulse_is_absorbed(finished):
    results = finished("absorbed_pulse")
    energy = results["kinetic_energy"] + results["strain_energy"]
    assert energy[-1] < 1e-5 * energy[0]


def test_a_box_floats(finished):
    """After half a period it is higher by two amplitudes, after a period it is back."""
    results = finished("floating_box")
    way = results["center_y[box]"] - results["center_y[box]"][0]
    assert way.max() == pytest.approx(0.4, rel=0.01)
    assert way[-1] == pytest.approx(0, abs=0.01)


def test_steel_sheared_to_and_fro(finished):
    """√3 τ = Y after every reversal, of the shears that the table of rates makes."""
    results = finished("cyclic_shear")
    table = results.to_pandas("middle")
    shear = table["deformation_gradient_xy"].to_numpy()
    turns = [np.argmax(shear), len(shear) // 3 + np.argmin(shear[len(shear) // 3 :]), len(shear) - 1]
    path = shear[turns]
    assert path == pytest.approx([0.080, 0.008, 0.076], abs=0.002)

    def flow(alpha: float) -> float:
        return 900 - 500 * math.exp(-alpha / 0.05)

    for count in (1, 2, 3):
        exact = material_elements.flow_after(flow, 80e3, math.sqrt(3), *path[:count])
        assert table["stress_xy"][turns[count - 1]] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("degrees", [0, 45])
def test_a_ply_pulled_at_an_angle(finished, degrees):
    """1/E = c⁴/E₁ + s⁴/E₂ + c²s²(1/G₁₂ − 2ν₁₂/E₁)."""
    results = finished("pulled_ply", "-D", f"angle={degrees}")
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    exact = c**4 / 10 + s**4 + (c * s) ** 2 * (1 / 0.6 - 2 * 0.3 / 10)
    assert of(results, "strain", "XX") / 1e-6 == pytest.approx(exact, rel=2e-3)


def test_rubber_pulled_by_a_grip(finished):
    """(G1 + G2/λ)(λ² − 1/λ) at the stretch λ of the middle, until the grip feels the force."""
    results = finished("pulled_rubber")
    table = results.to_pandas("middle")
    stretch = table["deformation_gradient_xx"].to_numpy()
    exact = (0.7 + 0.3 / stretch) * (stretch**2 - 1 / stretch)
    late = stretch > 1.05
    assert table["stress_xx"].to_numpy()[late] == pytest.approx(exact[late], rel=5e-3)
    force = results["reaction_x[pull]"]
    assert force[:-1].max() < 0.7 < force[-1] < 0.75
    assert stretch[-1] > 1.2


def test_a_released_bar(finished):
    """After L/2c all of the energy moves the bar; after L/c it is pressed as much as it was strained."""
    results = finished("released_bar")
    energy = 0.5 * 2 * 1e-4**2 * 10
    assert results["strain_energy"][0] == pytest.approx(energy, rel=1e-3)
    assert results["kinetic_energy"].max() == pytest.approx(energy, rel=0.03)
    x = results.particles().X[:, 0]
    assert of(results, "stress", "XX")[(x > 2) & (x < 8)].mean() == pytest.approx(-2e-4, rel=0.02)


def test_a_sheet_is_stretched_and_pressed_back(finished):
    """Hill's R-value r0 in tension; the event at 5 %; the yield stress of both directions is alike."""
    results = finished("sheet_metal")
    xx, yy, zz = (results[f"strain_{c}[sheet]"] for c in ("xx", "yy", "zz"))
    turn = int(np.argmax(xx))
    assert 0.049 < xx[turn] < 0.051
    early = int(np.searchsorted(xx[:turn], 0.02))
    ratio = (yy[turn - 1] - yy[early]) / (zz[turn - 1] - zz[early])
    assert ratio == pytest.approx(1.8, rel=0.04)
    stress = results["stress_xx[sheet]"]
    assert stress[turn - 1] == pytest.approx(
        300 * (1 + (xx[turn] - stress[turn - 1] / 200e3) / 0.01) ** 0.2, rel=0.02
    )
    assert -330 < stress[-1] < -300


def test_ground_with_a_water_table_stays_at_rest(finished):
    results = finished("ground_in_water")
    y, stress = results.particles(0.0).X[:, 1], of(results, "stress", "YY", 0.0)
    exact = -9.81 * (2000 * (4 - y) - 1000 * np.maximum(2.7 - y, 0))
    np.testing.assert_allclose(stress, exact, rtol=1e-10)
    speed = np.sqrt(2 * results["kinetic_energy"].max() / (2000 * 8))
    assert speed < 0.005


def test_a_disk_between_point_forces(finished):
    """Hertz: at the centre 2F/πDt across and −6F/πDt along the line of the forces."""
    results = finished("disk_between_points")
    middle = np.hypot(*results.particles().X[:, :2].T) < 1.0
    unit = 0.01 / (math.pi * 20)
    assert of(results, "stress", "XX")[middle].mean() == pytest.approx(2 * unit, rel=0.02)
    assert of(results, "stress", "YY")[middle].mean() == pytest.approx(-6 * unit, rel=0.02)
    assert results["kinetic_energy"][-1] < 1e-9 * results["strain_energy"][-1]


def test_a_column_of_particles_with_numbers_of_their_own(finished):
    """Stress and displacement of a column whose density and modulus grow with depth, once feedback made it rest."""
    results = finished("graded_column")
    x = np.sort(0.125 + 0.25 * np.arange(40))
    order = np.argsort(results.particles().X[:, 0])
    density, E = 1800 + 40 * (10 - x), 2e7 + 4e6 * (10 - x)
    weight = 9.81 * density * 0.25
    stress = -(np.cumsum(weight[::-1])[::-1] - weight / 2)
    assert np.abs(of(results, "stress", "XX")[order] - stress).max() < 0.015 * -stress[0]
    strain = stress / (E * 0.75 / (1.25 * 0.5)) * 0.25
    moved = np.cumsum(strain) - strain / 2
    assert np.abs(of(results, "displacement", "X")[order] - moved).max() < 0.005 * -moved[-1]
    assert 0 < results["feedback_rate"].max() <= 30
    assert results["kinetic_energy"][-1] < 1e-5 * results["strain_energy"][-1]


@pytest.mark.parametrize("T", [305, 300])
def test_a_bar_of_polymer_relaxes_faster_where_it_is_warm(finished, T):
    """Stress of a strain that grows evenly and then stays, with a time constant that temperature shifts."""
    results = finished("warm_polymer", "-D", f"T={T}")
    t, end, rate = results["time"], 0.05, 0.001 / 0.05
    tau = 10 ** (-17.44 * (T - 300) / (51.6 + T - 300))
    relaxed = np.exp(-np.maximum(t - end, 0) / tau) - np.exp(-t / tau)
    exact = -(1000 + 40 / 3) * rate * np.minimum(t, end) - 800 * rate * tau * relaxed
    assert np.abs(results["stress_xx[bar]"] - exact).max() < 0.001 * np.abs(exact).max()
