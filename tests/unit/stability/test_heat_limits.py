"""What is foreseen of heat conduction: stable Fourier numbers, waves that FMPM removes, reach, and warnings."""

from dataclasses import replace

import numpy as np
import pytest

from mpmcli.cli.main import call
from mpmcli.core.errors import SceneError
from mpmcli.scene.loader import load_scene
from mpmcli.shapes import SHAPES
from mpmcli.stability.bodies import largest_wave_speed
from mpmcli.stability.conduction import LARGEST, Conduction, filter_factor, finest_wave, fourier_limit
from mpmcli.stability.heat import chosen_fourier, diffusivities, forecast, stable_fourier, warnings_of_heat
from mpmcli.stability.lattice import Lattice
from mpmcli.stability.scene_limit import SAFETY, warning_of

SCENE = """\
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [40, 20], cell: 0.5}
method: {shape: ugimp, transfer: {kind: flip}}
heat: {}
materials:
  steel: {kind: linear_elastic, density: 2, E: 200, nu: 0, heat_capacity: 5, conductivity: 3}
  cork: {kind: linear_elastic, density: 1, E: 1, nu: 0, heat_capacity: 2, conductivity: [0.1, 0.2, 70]}
bodies:
  - {name: bar, material: steel, region: {kind: box, lower: [2, 2], upper: [22, 10]}}
  - {name: lid, material: cork, region: {kind: box, lower: [2, 10], upper: [12, 12]}}
time: {end: 100, courant: 0.2}
"""
DIFFUSIVITY, CELL = 0.3, 0.5


def scene_of(*sets):
    return load_scene(SCENE, sets=sets).scene


KEYS = {
    "film": "coefficient: 1e9, around: 300",
    "heat_flux": "flux: 1",
    "radiation": "emissivity: 1, around: 300, stefan_boltzmann: 1",
}


def with_faces(*axes, kind="temperature", body="bar", sets=()):
    """The scene with temperatures held at faces of a body, or loads of another kind there."""
    key, numbers = ("boundary", "value: 300") if kind == "temperature" else ("loads", KEYS[kind])
    members = [
        f"{{name: {a}, kind: {kind}, on: {{body: {body}, face: {{axis: {a}, side: lower}}}}, {numbers}}}"
        for a in axes
    ]
    return scene_of(*sets, f"{key}=[{', '.join(members)}]")


def conduction(shape, method, faces=0, particles=2):
    kind, order = method
    row = Lattice(SHAPES[shape].grid_functions, SHAPES[shape].domain, particles)
    return Conduction(row, kind == "fmpm", order, faces)


FLIP, FLIP4 = ("flip", 1), ("flip", 4)
FMPM1, FMPM2, FMPM4, FMPM8 = (("fmpm", k) for k in (1, 2, 4, 8))


# ---------------------------------------------------------------------- blocks

# largest stable Fourier numbers of an independent 1D code
REFERENCE = [
    ("ugimp", FLIP, 0, 1.505), ("ugimp", FLIP4, 0, 0.703), ("ugimp", FMPM1, 0, 1.095), ("ugimp", FMPM2, 0, 0.789),
    ("ugimp", FMPM4, 0, 0.615), ("ugimp", FMPM8, 0, 0.528), ("b2gimp", FLIP, 0, 2.756), ("b2gimp", FMPM8, 0, 1.124),
    ("bspline2", FMPM4, 0, 1.065), ("ugimp", FLIP, 1, 0.414), ("ugimp", FLIP4, 1, 0.279), ("ugimp", FMPM1, 1, 0.352),
    ("ugimp", FMPM2, 1, 0.296), ("ugimp", FMPM4, 1, 0.266), ("ugimp", FMPM8, 1, 0.253), ("b2gimp", FLIP, 1, 0.517),
    ("bspline2", FMPM4, 1, 0.333),
]  # fmt: skip


@pytest.mark.parametrize(("shape", "method", "faces", "reference"), REFERENCE)
def test_limits_of_blocks_are_those_of_the_reference(shape, method, faces, reference, monkeypatch):
    monkeypatch.setattr("mpmcli.stability.conduction.LARGEST", 3.0)
    limit = fourier_limit.__wrapped__(conduction(shape, method, faces))
    assert limit == pytest.approx(reference, rel=0.03)


def test_faces_along_several_axes_lower_the_limit_further():
    for method in (FLIP, FMPM4):
        limits = [fourier_limit(conduction("ugimp", method, faces)) for faces in range(4)]
        assert limits[0] == LARGEST
        assert limits == sorted(limits, reverse=True)
        assert 0.5 * limits[1] < limits[2] < 0.75 * limits[1]
        assert 0.6 * limits[2] < limits[3] < 0.85 * limits[2]


def test_more_particles_lie_nearer_to_their_faces():
    limits = [fourier_limit(conduction("ugimp", FLIP, 1, particles)) for particles in (1, 2, 3, 4)]
    assert limits == sorted(limits, reverse=True)
    assert limits[3] < 0.2


def test_faces_of_thin_bodies_lower_the_limit_further():
    def limit(cells):
        block = conduction("ugimp", FLIP, 1)
        return fourier_limit(replace(block, row=replace(block.row, cells=cells)))

    assert limit(6) == limit(100)
    assert limit(1) == pytest.approx(0.25)  # both faces act on one temperature
    assert limit(1) < limit(2) <= limit(6)


def test_insulated_blocks_of_ugimp_and_splines_keep_half_at_every_order():
    for shape in ("ugimp", "bspline2", "b2gimp", "lcpdi"):
        for particles in (1, 2, 3, 4):
            assert fourier_limit(conduction(shape, FMPM4, 0, particles)) == LARGEST
    assert fourier_limit(conduction("linear", FMPM4, 0, 4)) == pytest.approx(0.405, abs=0.006)


# ---------------------------------------------------------------------- waves

FILTERED = {
    "ugimp": {4: 0.375, 8: 0.109835, 16: 0.0285452, 40: 0.00461687},
    "linear": {4: 0.375, 8: 0.109835, 16: 0.0285452, 40: 0.00461687},
    "b2gimp": {4: 0.493056, 8: 0.15448, 16: 0.0409503, 40: 0.00666145},
}


@pytest.mark.parametrize("shape", FILTERED)
def test_filter_factors_are_those_of_the_reference(shape):
    for wavelength, factor in FILTERED[shape].items():
        assert filter_factor(conduction(shape, FMPM1), wavelength) == pytest.approx(factor, rel=1e-5)


@pytest.mark.parametrize("order", [1, 2, 4, 8])
@pytest.mark.parametrize("steps", [10, 1e3, 1e5])
@pytest.mark.parametrize("shape", ["ugimp", "b2gimp"])
def test_the_finest_wave_keeps_one_part_in_e(shape, order, steps):
    block = conduction(shape, ("fmpm", order))
    wave = finest_wave(block, steps)
    kept = (1.0 - filter_factor(block, wave) ** order) ** steps
    assert kept == pytest.approx((1 - 1 / steps) ** steps, rel=1e-3)


def test_the_finest_wave_grows_as_the_root_of_the_steps():
    """2.72 N^(1/(2k)) cells."""
    assert finest_wave(conduction("ugimp", FMPM1), 1e5) == pytest.approx(2.72 * 1e5**0.5, rel=0.01)
    assert finest_wave(conduction("ugimp", FMPM2), 1e5) == pytest.approx(2.72 * 1e5**0.25, rel=0.02)
    assert finest_wave(conduction("ugimp", FMPM8), 1.0) == 2.0
    assert 2.0 <= finest_wave(conduction("ugimp", ("fmpm", 100)), 1e9) < 3.0


# ---------------------------------------------------------------------- scenes


def test_the_diffusivity_has_the_largest_conductivity_of_the_axes_of_the_analysis():
    assert diffusivities(scene_of()) == pytest.approx({"steel": DIFFUSIVITY, "cork": 0.1})
    line = load_scene(
        SCENE,
        sets=[
            "analysis.kind=3d", "grid={lower: [0, 0, 0], upper: [40, 20, 1], cell: 0.5}",
            "bodies.bar.region={kind: box, lower: [2, 2, 0], upper: [22, 10, 1]}",
            "bodies.lid.region={kind: box, lower: [2, 10, 0], upper: [12, 12, 1]}",
        ],
    )  # fmt: skip
    assert diffusivities(line.scene)["cork"] == pytest.approx(35)


def test_no_forecast_without_conduction():
    scene = scene_of()
    assert forecast(scene.model_copy(update={"heat": None})) is None
    assert warnings_of_heat(scene.model_copy(update={"heat": None})) == []


def test_a_step_of_waves_is_kept_where_conduction_allows_it():
    found = forecast(scene_of())
    assert found.dt == pytest.approx(0.2 * CELL / 10)
    assert found.fourier == pytest.approx(DIFFUSIVITY * found.dt / CELL**2)
    assert found.interval == 1
    assert found.heat_steps == 10_000
    assert found.reach == pytest.approx(np.sqrt(DIFFUSIVITY * 100) / CELL)
    assert found.filter is None


@pytest.mark.parametrize("interval", [1, 5])
def test_conduction_shortens_steps_of_a_courant_number(interval):
    found = forecast(scene_of("materials.steel.conductivity=3000", f"heat.interval={interval}"))
    assert found.fourier == pytest.approx(0.25)
    assert found.interval == interval
    assert found.dt == pytest.approx(0.25 * CELL**2 / 300 / interval)


def test_auto_takes_the_largest_interval():
    assert forecast(scene_of("heat.interval=auto")).interval == 20  # 0.25/0.012
    assert forecast(scene_of("heat.interval=auto", "heat.fourier=0.1")).interval == 8
    slowly = ("heat.interval=auto", "materials.steel.conductivity=0.3", "materials.cork.conductivity=0")
    assert forecast(scene_of(*slowly)).interval == 100
    assert forecast(scene_of("heat.interval=auto", "time={end: 100, step: 0.1}")).interval == 2
    assert forecast(scene_of(*slowly, "bodies.bar.velocity=[0.7, 0]")).interval == 35


def test_a_run_may_end_by_its_number_of_steps():
    found = forecast(scene_of("time.max_steps=100", "heat.interval=10"))
    assert found.heat_steps == 10
    assert found.reach == pytest.approx(np.sqrt(DIFFUSIVITY * 100 * 0.01) / CELL)


def test_speeds_of_the_simulation_take_the_place_of_those_of_the_scene():
    assert forecast(scene_of(), 20.0, 0.0).dt == pytest.approx(0.2 * CELL / 20)
    assert forecast(scene_of(), 1.0, 50.0).dt == pytest.approx(0.2 * CELL / 50)


@pytest.mark.parametrize(
    "sets",
    [["materials.steel.conductivity=1e29"], ["materials.steel.density=1e-300"], ["materials.steel.E=1e300"]],
)
def test_numbers_of_any_size_end_in_a_forecast_or_none(sets):
    for more in (
        [],
        ["heat.interval=auto"],
        ["time={end: 100, step: 1e-300}"],
        ["grid.cell=20", "time.end=1e300"],
    ):
        try:
            scene = scene_of(*sets, *more)
        except SceneError:
            continue
        assert all(problem.message for problem in warnings_of_heat(scene))


# ---------------------------------------------------------------------- limits of scenes


def test_the_limit_names_the_body_and_its_faces():
    limit, because = stable_fourier(scene_of())
    assert (limit, because) == (LARGEST, "body 'bar'")
    limit, because = stable_fourier(with_faces("x"))
    assert limit == pytest.approx(0.41)
    assert because == "body 'bar', with temperatures or films at faces along 1 axis"
    limit, because = stable_fourier(with_faces("x", "y", kind="film", sets=["heat.transfer={kind: fmpm}"]))
    assert limit == pytest.approx(0.19, abs=0.006)
    assert because.endswith("along 2 axes")
    assert stable_fourier(with_faces("x", kind="heat_flux"))[0] == LARGEST
    assert stable_fourier(with_faces("x", kind="radiation"))[0] == pytest.approx(0.41)


def test_bodies_that_conduct_less_have_a_higher_limit():
    limit, because = stable_fourier(with_faces("x", body="lid"))
    assert (limit, because) == (LARGEST, "body 'bar'")
    cork = "materials.cork.conductivity=0.5"  # D = 0.25
    limit, because = stable_fourier(with_faces("x", "y", body="lid", sets=[cork]))
    assert limit == pytest.approx(0.28 * 0.3 / 0.25)  # its faces count as held at both ends
    assert because.startswith("body 'lid'")


def test_nothing_that_conducts_has_no_limit():
    scene = scene_of("materials.steel.conductivity=0", "materials.cork.conductivity=0")
    assert stable_fourier(scene) == (LARGEST, "no body conducts heat")
    assert forecast(scene).fourier == forecast(scene).reach == 0.0
    assert warnings_of_heat(scene) == []


def test_what_auto_selects_is_stable():
    faces = with_faces("x", "y", sets=["heat={interval: auto, transfer: {kind: fmpm}}"])
    assert chosen_fourier(faces) == pytest.approx(SAFETY * stable_fourier(faces)[0])
    assert chosen_fourier(faces) < 0.19
    assert chosen_fourier(with_faces("x", sets=["time.courant=auto", "heat.fourier=2"])) < 0.4
    assert chosen_fourier(scene_of("heat.interval=auto")) == 0.25
    assert chosen_fourier(scene_of("heat.fourier=2")) == 2.0
    by_itself = with_faces("x", "y", sets=["heat.transfer={kind: fmpm}"])
    assert chosen_fourier(by_itself) == pytest.approx(SAFETY * stable_fourier(by_itself)[0])


# ---------------------------------------------------------------------- warnings


def test_a_fixed_step_above_the_limit_is_a_warning_that_names_both_numbers():
    assert warnings_of_heat(scene_of("time={end: 100, step: 0.4}")) == []
    (above,) = warnings_of_heat(scene_of("time={end: 100, step: 0.5}"))
    assert (above.path, above.severity, above.code) == ("time.step", "warning", "unstable")
    assert (
        "this is the Fourier number 0.6 (Courant number 10), which is above the stable Fourier number 0.5"
        in (above.message)
    )
    (above,) = warnings_of_heat(scene_of("time={end: 100, step: 0.05}", "heat.interval=10"))
    assert above.message.startswith("10 steps are the Fourier number 0.6 (Courant number 1)")
    assert warnings_of_heat(scene_of("time={end: 100, step: 0.05}", "heat.interval=auto")) == []


def test_a_fourier_number_above_the_limit_is_a_warning_where_it_sets_the_step():
    fast = "materials.steel.conductivity=3000"
    assert warnings_of_heat(scene_of(fast)) == []
    assert warnings_of_heat(scene_of("heat.fourier=0.8")) == []  # waves set the step
    (above,) = warnings_of_heat(scene_of(fast, "heat.fourier=0.8"))
    assert (above.path, above.code) == ("heat.fourier", "unstable")
    assert above.message.startswith(
        "0.8 is above the stable Fourier number 0.5 of heat conduction (body 'bar')"
    )
    assert above.message.endswith("use 0.47 or less")
    faces = [fast, "heat.transfer={kind: fmpm, order: 8}"]
    assert [w.code for w in warnings_of_heat(with_faces("x", "y", sets=faces))] == ["inaccurate"]
    above, _ = warnings_of_heat(with_faces("x", "y", sets=[*faces, "heat.fourier=0.25"]))
    assert above.message.startswith("0.25 is above the stable Fourier number 0.18")


def test_fmpm_that_filters_the_bodies_is_a_warning():
    assert warnings_of_heat(scene_of("heat.transfer={kind: flip, order: 8}")) == []
    assert warnings_of_heat(scene_of("heat.transfer={kind: fmpm, order: 8}")) == []
    (found,) = warnings_of_heat(scene_of("heat.transfer={kind: fmpm, order: 2}"))
    assert (found.path, found.code) == ("heat.transfer", "inaccurate")
    wave = finest_wave(conduction("ugimp", FMPM2), 1e4)
    assert (
        f"in 1e+04 heat steps FMPM(2) removes most of all waves shorter than {wave:.3g} cells"
        in found.message
    )
    assert "body 'lid' is 20 cells long" in found.message
    for cure in ("{kind: fmpm, order: 2, every_steps: 1000}", "{kind: fmpm, order: 4, every_steps: 100}"):
        assert warnings_of_heat(scene_of(f"heat.transfer={cure}")) == []


@pytest.mark.parametrize(
    ("sets", "path", "words"),
    [
        (("heat.interval=101", "time={end: 100, step: 1}"), "heat.interval", "the run ends before 101 steps"),
        (("heat.interval=1000",), "heat.interval", "shortens the time step"),
        (
            ("heat.transfer={kind: fmpm, order: 8, every_steps: 100000000}",),
            "heat.transfer.every_steps",
            "so that FMPM never acts",
        ),
    ],
)
def test_heat_steps_that_never_come_or_shorten_all_steps_are_warnings(sets, path, words):
    found = [w for w in warnings_of_heat(scene_of(*sets)) if w.path == path]
    assert len(found) == 1
    assert words in found[0].message
    assert [w.path for w in warnings_of_heat(scene_of("heat.interval=2"))] == []


def test_pic_is_always_a_warning():
    (found,) = warnings_of_heat(scene_of("heat.transfer={kind: fmpm, order: 1, every_steps: 10000}"))
    assert "FMPM(1) (PIC)" in found.message


def test_conduction_that_reaches_no_cell_is_a_warning():
    (found,) = warnings_of_heat(
        scene_of("materials.steel.conductivity=1e-5", "materials.cork.conductivity=1e-7")
    )
    assert (found.path, found.code) == ("heat", "no_effect")
    assert found.message == "conduction reaches 0.02 cells in this run: it has no effect on this grid"


def test_validate_tells_the_place_of_the_warning(tmp_path, capsys):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.replace("heat: {}", "heat: {transfer: {kind: fmpm, order: 1}}"))
    assert call(["validate", str(path)]) == 0
    assert f"{path}:5:18  heat.transfer" in capsys.readouterr().out


# ---------------------------------------------------------------------- waves where heat and strain are coupled


def test_waves_are_adiabatic_where_work_heats():
    """c² grows by γ²c_vT, γ = 3αK/(ρc_v): here 100 by (3·0.02·66.7/(2·5))²·5·300 = 240."""
    expands = "materials.steel.expansion=0.02"
    assert largest_wave_speed(scene_of()) == pytest.approx(10.0)
    assert largest_wave_speed(scene_of(expands, "method.heating=isothermal")) == pytest.approx(10.0)
    gamma = 3 * 0.02 * (200 / 3) / (2 * 5)
    speed = np.sqrt(100 + gamma**2 * 5 * 300)
    assert largest_wave_speed(scene_of(expands)) == pytest.approx(speed)
    assert forecast(scene_of(expands)).dt == pytest.approx(0.2 * CELL / speed)


def test_courant_numbers_are_those_of_adiabatic_waves():
    expands, step = "materials.steel.expansion=0.02", "time={end: 100, step: 0.05}"
    assert "Courant number 1," in warning_of(scene_of(step)).message
    courant = 0.05 * largest_wave_speed(scene_of(expands)) / CELL
    assert f"Courant number {courant:.3g}," in warning_of(scene_of(expands, step)).message
