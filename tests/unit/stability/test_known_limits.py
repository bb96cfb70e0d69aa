"""Predicted stability limits: the matrices are those of the solver, the limits those of the vibrating bar."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from mpmcli.cli.main import call
from mpmcli.cli.options import check_time_step
from mpmcli.core.analysis import ANALYSES
from mpmcli.core.errors import SceneError
from mpmcli.run.api import run
from mpmcli.scene.loader import load_scene
from mpmcli.shapes import SHAPES
from mpmcli.solver.explain import explain
from mpmcli.solver.simulation import Simulation
from mpmcli.stability import growth, scene_limit
from mpmcli.stability.blocks import Flight, NoKnownLimit, blocks_of, swing_of
from mpmcli.stability.growth import flying_limit, moving_limit, slow_limit, worst_limit
from mpmcli.stability.held import held_axes, held_faces
from mpmcli.stability.lattice import Lattice, axis_stencils, stencils
from mpmcli.stability.linear_step import LinearStep, Scheme, State
from mpmcli.stability.scene_limit import (
    SAFETY,
    KnownLimit,
    Prediction,
    chosen_courant,
    courant_of_waves,
    known_limit,
    predict,
    refuse_large_courant,
    warning_of,
)
from mpmcli.stability.speeds import largest_speed, swinging_axes
from mpmcli.study.transfers import transfer_value

SLOW = pytest.mark.slow
ROOT = Path(__file__).parents[3]
INPUTS = ROOT / "inputs"
SHIPPED = sorted([*INPUTS.glob("*.yaml"), *(ROOT / "mpmcli" / "scene" / "templates").glob("*.yaml")])

MEASURED = [  # order, largest stable Courant number of inputs/vibrating_bar.yaml ("mpmcli stability", lcpdi)
    ("flip", 1, 0.855),
    ("fmpm", 1, 0.89),
    ("fmpm", 2, 0.685),
    ("fmpm", 4, 0.54),
    ("fmpm", 8, 0.405),
    ("fmpm", 16, 0.32),
    ("fmpm", 40, 0.27),
]


def lattice(shape: str, dimensions: int = 1, particles: int = 2) -> Lattice:
    entry = SHAPES[shape]
    return Lattice(entry.grid_functions, entry.domain, particles, (1.0,) * dimensions)


@pytest.mark.parametrize(("kind", "order", "measured"), MEASURED)
def test_limits_of_the_vibrating_bar(kind, order, measured):
    assert moving_limit(lattice("lcpdi"), Scheme(kind, order)) == pytest.approx(measured, rel=0.08)


def test_a_body_at_rest_at_the_worst_place_has_the_lower_limit():
    for order in (1, 4, 16):
        block, scheme = lattice("lcpdi"), Scheme("fmpm", order)
        assert 0.6 * moving_limit(block, scheme) < worst_limit(block, scheme)
        assert worst_limit(block, scheme) <= slow_limit(block, scheme) < moving_limit(block, scheme)


def test_order_blend_and_period():
    def limit(**scheme):
        return moving_limit(lattice("lcpdi"), Scheme("fmpm", **scheme))

    assert limit(order=1) > limit(order=2) > limit(order=4) > limit(order=8)
    assert limit(order=8, blend=(1, 1.0)) == limit(order=8)
    assert limit(order=8, blend=(1, 0.0)) == limit(order=1)
    assert limit(order=8) < limit(order=8, blend=(2, 0.8)) < limit(order=8, blend=(1, 0.8))
    assert limit(order=8, every_steps=1) == limit(order=8)
    assert limit(order=8) < limit(order=8, every_steps=4) < 0.86


def test_what_a_scene_says():
    bar = INPUTS / "vibrating_bar.yaml"
    loaded = load_scene(bar, sets=["method.transfer={kind: flip}"])
    assert predict(loaded.scene) == Prediction(pytest.approx(0.8475), pytest.approx(0.655))
    plane = load_scene(INPUTS / "block_impact.yaml").scene
    (found,) = {block.lattice for block in blocks_of(plane)}
    assert found.dimensions == 2
    assert 0.0 < found.shear < 0.5
    assert found.lame + 2 * found.shear == pytest.approx(1.0)


def read_measured() -> list[dict[str, str]]:
    """Limits measured with ``mpmcli stability`` on the scenes of inputs/."""
    with (ROOT / "tests" / "data" / "limits_of_scenes.csv").open() as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize(
    "row", read_measured(), ids=lambda row: f"{row['scene']} {row['shape']} {row['transfer']}"
)
@SLOW
def test_the_chosen_courant_number_is_stable_and_wastes_little(row):
    """Less than 15 % of the measured limit is given away; where more is, the table says how much.

    So it is before anything moves; ``choice`` takes less where faces come to rest, or more where they lie well.
    """
    sets = [f"method.shape={row['shape']}", f"method.transfer={transfer_value(row['transfer'])}"]
    path = INPUTS / f"{row['scene']}.yaml"
    scene = load_scene(path, sets=sets, defines=[d for d in [row["define"]] if d]).scene
    scene = scene.model_copy(update={"time": scene.time.model_copy(update={"courant": "auto", "step": None})})
    chosen, stable, unstable = chosen_courant(scene), float(row["stable"]), float(row["unstable"])
    assert chosen < unstable - 0.2 * (unstable - stable)
    assert 1.0 - chosen / float(row["quiet"] or stable) <= float(row["waste"] or 0.15) + 0.005
    assert chosen == pytest.approx(SAFETY * known_limit(scene).courant) or chosen == 1.0


def bar(**time):
    scene = load_scene(INPUTS / "vibrating_bar.yaml").scene
    given = {"courant": None, "step": None} | time
    return scene.model_copy(update={"time": scene.time.model_copy(update=given)})


def test_auto_is_a_share_of_the_limit():
    scene = bar(courant="auto")
    assert chosen_courant(scene) == pytest.approx(SAFETY * known_limit(scene).courant)
    assert 0.85 * 0.54 < chosen_courant(scene) < 0.54
    assert chosen_courant(bar(courant=0.3)) == 0.3
    assert chosen_courant(bar(step=0.1)) is None


def test_a_step_above_the_limit_is_a_warning():
    assert warning_of(bar(courant=0.5)) is None
    assert warning_of(bar(step=0.25)) is None
    above = warning_of(bar(courant=0.6))
    assert (above.path, above.severity) == ("time.courant", "warning")
    assert "0.6 is above the stability limit 0.522 (body 'bar', moving)" in above.message
    above = warning_of(bar(step=0.3))
    assert above.path == "time.step"
    assert "Courant number 0.6, which is above the stability limit 0.522" in above.message


B2CPDI = ("method.shape=b2cpdi", "method.transfer={kind: flip}")
FAST_BAR = "bodies.bar.velocity=['3*sqrt(2/0.5)']"
UNKNOWN = ("materials.elastic.E=1e-300", "materials.elastic.density=1e100")


@pytest.mark.parametrize(
    ("sets", "courant", "words"),
    [
        (B2CPDI, 1.05, None),
        (B2CPDI, 1.2, r"1.2 is not possible: .* the scene is stable only to 1.07"),
        ((), 1.05, "the scene is stable only to 0.522"),
        ((*B2CPDI, FAST_BAR), 1.05, "3 times as fast as waves, would cross more than a cell"),
        (UNKNOWN, 1.05, "no stability limit is known"),
        (UNKNOWN, 1.0, None),
    ],
    ids=["stable", "above the limit", "another method", "fast", "unknown", "one"],
)
def test_above_one_a_courant_number_must_be_known_to_be_stable(sets, courant, words, tmp_path):
    """For ``validate``, ``explain`` and runs alike."""
    loaded = load_scene(INPUTS / "vibrating_bar.yaml", sets=[*sets, f"time.courant={courant}"])
    if words is None:
        refuse_large_courant(loaded.scene)
        check_time_step(loaded)
        assert loaded.warnings == []
        return
    for check in (
        check_time_step,
        lambda loaded: run(loaded, tmp_path / "run", dry_run=True, progress=False),
    ):
        with pytest.raises(SceneError, match=words) as error:
            check(loaded)
        (problem,) = error.value.problems
        assert (problem.path, problem.severity, problem.code) == ("time.courant", "error", "unstable")
    assert not (tmp_path / "run").exists()


@SLOW
def test_a_scene_runs_at_a_courant_number_above_one(tmp_path):
    sets = [*B2CPDI, "time.courant=1.05", "archive.particles=null", "archive.globals={every: 20}"]
    outcome = run(load_scene(INPUTS / "vibrating_bar.yaml", sets=sets), tmp_path / "run", progress=False)
    assert outcome.exit_code == 0
    assert abs(outcome.energy_error) < 0.05


@SLOW
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_no_shipped_scene_has_a_warning(path):
    """Nor a step above its own known limit."""
    loaded = load_scene(path)
    check_time_step(loaded)
    assert [str(warning) for warning in loaded.warnings] == []


def test_a_limit_is_only_looked_for_where_a_step_is_above_it(monkeypatch):
    def search(*_):
        raise AssertionError("no search is needed")

    monkeypatch.setattr(growth, "bisect_limit", search)
    for name, courant in (("vibrating_bar", 0.5051), ("two_disks", 0.3751), ("vibrating_bar_2d", 0.3351)):
        scene = load_scene(INPUTS / f"{name}.yaml", sets=[f"time.courant={courant}"]).scene
        assert warning_of(scene) is None
        assert known_limit(scene, enough=courant).courant >= courant
    with pytest.raises(AssertionError, match="no search"):
        warning_of(bar(courant=0.6051))


def test_a_limit_below_what_would_be_enough_is_the_limit():
    scene = load_scene(INPUTS / "vibrating_bar_2d.yaml", defines=["shift=0.5"]).scene
    limit = known_limit(scene)
    for share in (0.5, 0.95, 1.0):
        assert known_limit(scene, enough=share * limit.courant).courant >= share * limit.courant
    for share in (1.02, 1.5, 10.0):
        assert known_limit(scene, enough=share * limit.courant) == limit


def test_where_no_limit_is_known_auto_is_an_error_in_words():
    sets = ["materials.elastic.E=1e-300", "materials.elastic.density=1e100"]
    scene = load_scene(INPUTS / "vibrating_bar.yaml", sets=[*sets, "time.courant=auto"]).scene
    with pytest.raises(NoKnownLimit, match="'bar' has the wave speed 0"):
        known_limit(scene)
    with pytest.raises(SceneError, match="give a number") as error:
        chosen_courant(scene)
    assert error.value.problems[0].path == "time.courant"
    assert warning_of(load_scene(INPUTS / "vibrating_bar.yaml", sets=[*sets, "time.courant=1"]).scene) is None


def test_artificial_viscosity_lowers_the_limit():
    def limit(linear: float) -> float:
        viscosity = f"method.artificial_viscosity={{linear: {linear}, quadratic: 4}}"
        return known_limit(load_scene(INPUTS / "shock_nickel.yaml", sets=[viscosity]).scene).courant

    assert limit(0.8) < limit(0.4) < limit(0.0)
    assert limit(0.4) == pytest.approx(0.465)


FLIGHTS = [  # order, speed over wave speed, the largest limit that runs of long bars allow, and the predicted one
    ("fmpm", 2, 0.3, 0.66, 0.59),
    ("fmpm", 4, 0.2, 0.45, 0.3675),
    ("fmpm", 4, 0.4, 0.40, 0.3675),
    ("fmpm", 8, 0.2, 0.28, 0.24),
    ("fmpm", 8, 0.4, 0.20, 0.18),
]


@pytest.mark.parametrize(("kind", "order", "speed", "measured", "predicted"), FLIGHTS)
def test_fast_flight_lowers_the_limit_of_high_orders(kind, order, speed, measured, predicted):
    row = Lattice("linear", "corners", 2, is_endless=True)
    limit = flying_limit(row, Scheme(kind, order), speed)
    assert predicted <= limit < measured
    assert limit < flying_limit(row, Scheme(kind, order), 0.1) < flying_limit(row, Scheme("flip"), speed)


def limit_of_bar(velocity: str, transfer: str = "{kind: fmpm, order: 4}", *sets: str) -> KnownLimit:
    of_bar = [f"bodies.0.velocity={velocity}", f"method.transfer={transfer}", *sets]
    return known_limit(load_scene(INPUTS / "vibrating_bar.yaml", sets=of_bar).scene)


def test_bodies_that_fly_have_the_limit_of_flight():
    fast = limit_of_bar("[0.8]")  # waves have the speed 2
    assert fast.because == "body 'bar', flying at 0.4 of the wave speed"
    assert fast.courant == pytest.approx(0.3675)
    assert "moving" in limit_of_bar("[0.1]").because
    assert limit_of_bar('["0.7 + 0.1*x/40"]') == fast  # the fastest part counts
    assert "moving" in limit_of_bar("[0.8]", "{kind: flip}").because  # FLIP does not mind
    scene = load_scene(INPUTS / "vibrating_bar.yaml", sets=["bodies.0.velocity=[0.8003]"]).scene
    flights = [block.flight for block in blocks_of(scene)]
    assert flights == [None, Flight(0.4, 400 * 2.0)]  # no search for each digit


def test_stairs_that_do_not_move_across_a_flight_have_the_limit_of_slow_bodies():
    def found(*velocity: float) -> KnownLimit:
        sets = [f"bodies.{name}.velocity={list(velocity)}" for name in ("left", "right")]
        return known_limit(load_scene(INPUTS / "two_disks.yaml", sets=sets).scene)

    along, across, at_rest = found(80.0, 0.0), found(80.0, 80.0), found(0.0, 0.0)
    assert along.because == "body 'left', whose stairs rest in the grid"
    assert along.courant == at_rest.courant < 0.85 * across.courant
    assert "moving" in across.because
    assert "moving" in known_limit(load_scene(INPUTS / "block_impact.yaml").scene).because  # it has no stairs


def test_the_most_steps_of_a_run_cut_the_time_in_which_noise_grows():
    swing, transfer = '["v0*sin(pi*x/(2*L))"]', "{kind: fmpm, order: 4}"
    short = limit_of_bar(swing, transfer)
    long = ["time.end=1e8", "archive={}"]  # nothing follows each of its steps
    assert limit_of_bar(swing, transfer, *long).courant < 0.5 * short.courant
    assert limit_of_bar(swing, transfer, *long, "time.max_steps=300") == short
    assert limit_of_bar(swing, "{kind: fmpm, order: 2}", *long).courant > 0.3


def test_rows_fly_and_swing_by_cells_of_their_own_axis():
    scheme = Scheme("fmpm", 8)
    square, long = (Lattice("linear", "corners", 2, (edge,), is_endless=True) for edge in (1.0, 4.0))
    assert flying_limit(long, scheme, 0.4) == pytest.approx(4.0 * flying_limit(square, scheme, 0.4), rel=0.02)
    bar = (
        "version: 1\nanalysis: {kind: plane_strain}\ngrid: {lower: [0, 0], upper: [50, 4], cell: [1, EDGE]}\n"
        "method: {shape: lcpdi, update: usl, transfer: {kind: fmpm, order: 4}}\n"
        "materials: {m: {kind: linear_elastic, density: 1, E: 1, nu: 0}}\n"
        "bodies: [{name: bar, material: m, region: {kind: box, lower: [0, 0], upper: [40, 4]}, "
        "velocity: ['0.1*sin(pi*x/80)', 0]}]\n"
        "boundary:\n- {name: end, kind: symmetry, plane: {axis: x, at: 0}}\n"
        "- {name: low, kind: symmetry, plane: {axis: y, at: 0}}\n"
        "- {name: high, kind: symmetry, plane: {axis: y, at: 4}}\n"
        "time: {end: 100, courant: 0.2}\narchive: {globals: {every: 1}}\n"
    )
    scenes = [load_scene(bar.replace("EDGE", edge)).scene for edge in ("1", "0.5")]
    wide, narrow = (swing_of(scene, scene.bodies[0]) for scene in scenes)
    assert wide.amplitude == narrow.amplitude == pytest.approx(2 * 40 * 0.1 / np.pi)
    assert narrow.period == 2.0 * wide.period  # in times in which a wave crosses the smallest edge


def test_a_slow_swing_with_gradients_or_periods_is_no_row():
    swing = '["v0*sin(pi*x/(2*L))"]'
    for more, least in (("velocity_gradient: true", 0.58), ("every_courant: 2", 0.62)):
        assert limit_of_bar(swing, f"{{kind: fmpm, order: 8, {more}}}").courant > least
        fast = limit_of_bar(swing, f"{{kind: fmpm, order: 8, {more}}}", "constants.v0=0.4")
        assert fast.because == "body 'bar', flying at 0.2 of the wave speed"


def test_noise_has_no_time_to_grow_in_a_short_flight():
    row = Lattice("linear", "corners", 2, is_endless=True)
    long, some, short = (
        flying_limit(row, Scheme("fmpm", 8), 0.4, duration) for duration in (1e4, 100.0, 10.0)
    )
    assert long == flying_limit(row, Scheme("fmpm", 8), 0.4) < 0.9 * some < 0.8 * short


def test_the_end_of_a_bar_swings_about_the_place_where_it_starts():
    def swing(*sets: str):
        scene = load_scene(INPUTS / "vibrating_bar.yaml", sets=["constants.v0=0.02", *sets]).scene
        (found,) = {block.swing for block in blocks_of(scene)}  # of the block, and of the endless row
        return found

    assert swing().place == 0.0
    assert swing().amplitude == pytest.approx(2 * 40 * 0.02 / (np.pi * 2))
    assert swing("bodies.bar.region.upper=[40.5]").place == 0.5
    particles = ["bodies.bar.region.upper=[40.25]", "bodies.bar.particles_per_axis=4"]
    assert swing(*particles).place == 0.25
    assert swing("bodies.bar.velocity=[0.02]") is None  # it strikes its support


@pytest.mark.parametrize(("v0", "order", "measured"), [(0.05, 4, 0.44), (0.2, 2, 0.60), (0.2, 4, 0.46)])
def test_ends_that_turn_amid_a_cell_lower_the_limit(v0, order, measured):
    transfer = f"{{kind: fmpm, order: {order}}}"
    swings = limit_of_bar('["v0*sin(pi*x/(2*L))"]', transfer, f"constants.v0={v0}")
    assert swings.because == "body 'bar', whose end swings"
    assert 0.93 * measured < swings.courant < measured + 0.005


@pytest.mark.parametrize(
    ("order", "end", "stable", "unstable"),
    [(4, 400, 0.46, 0.47), (4, 1600, 0.30, 0.32), (2, 1600, 0.56, 0.58)],
)
def test_fast_swings_and_long_runs_lower_the_limit(order, end, stable, unstable):
    transfer = f"{{kind: fmpm, order: {order}}}"
    swings = limit_of_bar(
        '["v0*sin(pi*x/(2*L))"]', transfer, "constants.v0=0.3", f"time.end={end}", "grid.upper=[70]"
    )
    assert "swinging" in swings.because or "flying" in swings.because
    assert 0.85 * stable < swings.courant < unstable


FASTER_THAN_WAVES = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-5, -5], upper: [40, 20], cell: 1}
method: {shape: lcpdi, update: usl, transfer: {kind: flip}}
materials: {m: {kind: linear_elastic, density: 1, E: 1, nu: 0}}
bodies:
  - {name: a, material: m, region: {kind: box, lower: [0, 0], upper: [4, 4]}, velocity: [1.5, 0]}
  - {name: b, material: m, region: {kind: polygon, points: [[20, AT], [24, AT], [24, TO], [20, TO]]}}
time: {end: 10, courant: auto}
"""


def test_of_bodies_faster_than_waves_explain_tells_the_limit_of_its_courant_number():
    loaded = load_scene(FASTER_THAN_WAVES.replace("AT", "0.5").replace("TO", "4.5"))
    facts = explain(loaded, threads=1)  # the faces at rest are lower than known of a polygon
    assert facts["stability_limit_of"] == "of the initial state"
    assert facts["stability_margin"] == pytest.approx(1.0 - SAFETY)


def test_auto_of_waves_does_not_fall_where_the_number_of_particles_is_cut():
    loaded = load_scene(FASTER_THAN_WAVES.replace("AT", "0").replace("TO", "4"))
    scene = loaded.scene
    limit = known_limit(scene).courant
    assert (
        explain(loaded, threads=1)["stability_limit_of"] == known_limit(scene).because
    )  # but for the last digit
    assert SAFETY * limit > chosen_courant(scene) == 1.0
    assert courant_of_waves(scene) == pytest.approx(SAFETY * limit / 1.5)


def test_what_is_unstable_with_any_step_has_no_chosen_one(monkeypatch):
    monkeypatch.setattr(
        scene_limit, "known_limit", lambda scene: KnownLimit(0.0, "bar", "body 'bar', moving")
    )
    with pytest.raises(SceneError, match=r"body .bar., moving, is unstable at 0\.02 already; give a number"):
        chosen_courant(bar(courant="auto"))


def test_axes_whose_faces_are_held_are_no_axes_of_the_block():
    def held(name: str, *defines: str) -> list[list[bool]]:
        scene = load_scene(INPUTS / f"{name}.yaml", defines=defines).scene
        bodies = [b for b in scene.bodies if scene.materials[b.material].kind != "rigid"]
        return [held_axes(scene, body).tolist() for body in bodies]

    assert held("column_under_gravity") == [[True, False]]  # between symmetry planes
    assert held("shock_nickel") == [[True, True]]  # walls at the ends, a box of nodes without lateral motion
    assert held("compressed_by_rigid") == [[True, False]]  # a held plane and a rigid body
    assert held("cantilever_tip_load") == [[False, False]]  # clamped at one end only
    assert held("two_disks") == [[False, False]] * 2
    assert held("stretched_bar") == [[True, False]]
    scene = load_scene(INPUTS / "shock_nickel.yaml").scene
    assert {block.lattice.dimensions for block in blocks_of(scene)} == {1}


def test_the_axis_of_symmetry_holds_the_face_that_lies_there():
    def held(of: str, *sets: str) -> list[list[bool]]:
        scene = load_scene(INPUTS / f"{of}.yaml", sets=sets).scene
        return held_faces(scene, scene.bodies[0]).tolist()

    assert held("taylor_bar") == [[True, True], [False, False]]  # and the anvil
    assert held("taylor_bar", "analysis.kind=plane_strain") == [[False, True], [False, False]]
    hollow = "bodies.bar.region.lower=[1, 0]"
    assert held("taylor_bar", hollow) == [[False, True], [False, False]]


def test_speeds_at_the_start_are_those_of_the_body_not_of_its_box():
    scene = load_scene(INPUTS / "vortex.yaml").scene  # far from the ring its velocity is 100 times as large
    assert largest_speed(scene) == pytest.approx(0.5 * np.pi, rel=0.03)
    thin = ["bodies.ring.region.inner_radius=1.2", "bodies.ring.velocity=[x, 0]"]
    scene = load_scene(INPUTS / "vortex.yaml", sets=thin).scene
    assert largest_speed(scene) == pytest.approx(1.25, rel=0.03)


def test_which_ends_swing():
    def swings(name: str, *sets: str) -> list[bool]:
        scene = load_scene(INPUTS / f"{name}.yaml", sets=sets).scene
        return swinging_axes(scene, scene.bodies[0]).tolist()

    assert swings("vibrating_bar") == [True]
    assert swings("vibrating_bar", "bodies.bar.velocity=[0.16]") == [False]  # it strikes its support
    assert swings("vibrating_bar", "bodies.bar.velocity=[0]") == [False]
    assert swings("vibrating_bar", "boundary=[]") == [False]
    assert swings("vibrating_bar_2d") == [True, False]
    assert swings("taylor_bar") == [False, False]
    mirrored = ["bodies.bar.velocity=['v0*cos(pi*x/(2*L))']", "boundary.support.on.plane.at=40"]
    assert swings("vibrating_bar", *mirrored) == [True]


def test_faces_amid_cells_lower_the_limit():
    plane = INPUTS / "vibrating_bar_2d.yaml"
    aligned, shifted = (known_limit(load_scene(plane, defines=[f"shift={s}"]).scene) for s in (0, 0.5))
    assert shifted.courant < 0.8 * aligned.courant
    assert "amid cells" in shifted.because


def test_validate_and_explain_name_the_limit(capsys):
    path = str(INPUTS / "vibrating_bar.yaml")
    assert call(["validate", path, "--set", "time.courant=0.9"]) == 0
    assert "warning: 0.9 is above the stability limit 0.522 (body 'bar', moving)" in capsys.readouterr().out
    assert call(["explain", path, "--set", "time.courant=auto"]) == 0
    assert (
        "Courant number 0.517 (auto: 0.99 of the limit, at most 1), 1% below the estimated stability limit of 0.522"
        in capsys.readouterr().out
    )
    assert call(["explain", str(INPUTS / "cantilever_tip_load.yaml"), "--set", "time.courant=auto"]) == 0
    out = capsys.readouterr().out
    assert "0.381 when they are no longer flat), 1% below the estimated stability limit of 0.54" in out
    assert "(of the initial state)" in out
    no_limit = ["--set", "materials.elastic.E=1e-300", "--set", "materials.elastic.density=1e100"]
    assert call(["validate", path, *no_limit, "--set", "time.courant=auto"]) == 3
    assert "time.courant" in (out := capsys.readouterr().out)
    assert "no stability limit is known: body 'bar' has the wave speed 0" in out


@SLOW
def test_the_step_of_a_simulation_is_the_chosen_one():
    loaded = load_scene(INPUTS / "vibrating_bar.yaml", sets=["time.courant=auto"])
    simulation = Simulation(loaded, threads=1)
    simulation.step()
    assert simulation.state.dt == pytest.approx(chosen_courant(loaded.scene) * 1.0 / 2.0)


SCENE = """
version: 1
units: {length: m, mass: kg, time: s}
analysis: {kind: KIND}
grid: {lower: LOWER, upper: UPPER, cell: 1}
method: {shape: SHAPE, update: UPDATE, transfer: TRANSFER}
materials: {m: {kind: linear_elastic, density: 1, E: YOUNG, nu: POISSON}}
bodies:
  - {name: b, material: m, region: {kind: box, lower: FROM, upper: TO}, particles_per_axis: 2, velocity: VELOCITY}
time: {end: 10, courant: 0.4}
"""
TINY = 1e-8


def simulated(dimensions: int, shape: str, update: str, transfer: str, offset: float):
    """A free block, shifted within its cells, with tiny random velocities."""
    L = lattice(shape, dimensions).edge
    kind = {1: "uniaxial_stress", 2: "plane_strain"}[dimensions]
    poisson = {1: 0.0, 2: 0.25}[dimensions]
    young = (1 + poisson) * (1 - 2 * poisson) / (1 - poisson)
    values = {
        "KIND": kind,
        "LOWER": [-5] * dimensions,
        "UPPER": [L + 5] * dimensions,
        "SHAPE": shape,
        "UPDATE": update,
        "TRANSFER": transfer,
        "YOUNG": young,
        "POISSON": poisson,
        "FROM": [0] * dimensions,
        "TO": [L] * dimensions,
        "VELOCITY": [0] * dimensions,
    }
    text = SCENE
    for name, value in values.items():
        text = text.replace(name, str(value))
    simulation = Simulation(load_scene(text), threads=1)
    p = simulation.particles
    # memory order as the lattice has it: the last axis fastest
    order = np.lexsort(p.X[::-1])
    V = np.random.default_rng(1).normal(size=p.V.shape)
    p.V[:, order] = TINY * V
    p.X += offset
    simulation.order.drift = np.inf
    ids = p.id[order].copy()
    return simulation, V, ids


CASES = [
    (1, "lcpdi", "usl", "{kind: flip}", Scheme()),
    (1, "lcpdi", "usl", "{kind: fmpm, order: 3}", Scheme("fmpm", 3)),
    (1, "lcpdi", "usl+", "{kind: fmpm, order: 3}", Scheme("fmpm", 3, "usl+")),
    (1, "lcpdi", "usavg", "{kind: fmpm, order: 2}", Scheme("fmpm", 2, "usavg")),
    (1, "lcpdi", "usl", "{kind: xpic, order: 3}", Scheme("xpic", 3)),
    (1, "lcpdi", "usf", "{kind: flip}", Scheme(update="usf")),
    pytest.param(1, "b2gimp", "usl", "{kind: fmpm, order: 2}", Scheme("fmpm", 2), marks=SLOW),
    pytest.param(1, "ugimp", "usl", "{kind: flip}", Scheme(), marks=SLOW),
    pytest.param(2, "lcpdi", "usl", "{kind: fmpm, order: 2}", Scheme("fmpm", 2), marks=SLOW),
]


@pytest.mark.parametrize(("dimensions", "shape", "update", "transfer", "scheme"), CASES)
def test_the_matrices_are_those_of_the_solver(dimensions, shape, update, transfer, scheme):
    offset, courant = 0.3, 0.4
    simulation, V, ids = simulated(dimensions, shape, update, transfer, offset)
    mu = {1: 0.0, 2: 1.0 / 3.0}[dimensions]
    block = lattice(shape, dimensions)
    block = Lattice(block.grid_functions, block.domain, 2, block.cell, 1 - 2 * mu, mu)
    step = LinearStep(block, scheme, courant)
    N = V.shape[1]
    state = State(V[:, None, :, None].copy(), np.zeros((len(step.pairs), 1, N, 1)), None)
    for _ in range(3):
        simulation.step()
        state = step.advance(state, stencils(block, np.full((1, dimensions), offset)))
    p = simulation.particles
    place = np.argsort(p.id)[ids]
    assert p.V[:, place] / TINY == pytest.approx(state.V[:, 0, :, 0], abs=1e-5)
    stresses = p.tau[:, place] / TINY
    analysis = ANALYSES[{1: "uniaxial_stress", 2: "plane_strain"}[dimensions]]()
    assert analysis.dimensions == dimensions
    rows = {1: [0], 2: [0, 3, 1]}[dimensions]
    assert stresses[rows] == pytest.approx(state.stress[:, 0, :, 0], abs=1e-5)
    assert np.abs(stresses[rows]).max() > 0.05


def test_functions_of_the_axes_sum_to_one():
    for name, entry in SHAPES.items():
        S, G, reach = axis_stencils(entry.grid_functions, entry.domain, 2, 3, np.array([0.37, 0.9]))
        assert S.sum(axis=-1) == pytest.approx(1.0), name
        assert G.sum(axis=-1) == pytest.approx(0.0, abs=1e-8), name
        assert reach.sum(axis=-1) == pytest.approx(0.0, abs=1e-8), name


@pytest.mark.parametrize(
    "changes",
    [
        ["bodies.0.velocity=[1e200]"],
        ["materials.elastic.E=1e300", "materials.elastic.density=1e-100"],
        ["materials.elastic.E=1e-100", "materials.elastic.density=1e300", "bodies.0.velocity=[1e308]"],
    ],
)
@pytest.mark.parametrize("time", [{"courant": 0.5}, {"step": 1e300}])
def test_speeds_beyond_all_measure_are_no_fault(changes, time):
    scene = load_scene(INPUTS / "vibrating_bar.yaml", sets=changes).scene
    span = scene.time.model_copy(update={"courant": None, "step": None} | time)
    warning = warning_of(scene.model_copy(update={"time": span}))
    assert warning is None or warning.severity == "warning"
