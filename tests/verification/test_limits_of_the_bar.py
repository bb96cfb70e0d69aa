"""Stability limits of the vibrating bar, measured once with ``mpmcli stability``: still so, and predicted so.

The limits are in ``tests/data/limits_of_the_bar.csv``, those of Nairn (2026), Fig. 12A, among them.
"""

import csv
from pathlib import Path

import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.stability.scene_limit import chosen_courant, limit_in_motion
from mpmcli.study.transfers import transfer_value
from mpmcli.study.trial import run_trial

ROOT = Path(__file__).parents[2]
INPUTS = ROOT / "inputs"
LOSS = 0.01
"""Of the criterion ``accurate``."""


def read_limits() -> list[dict[str, str]]:
    with (ROOT / "tests" / "data" / "limits_of_the_bar.csv").open() as file:
        return list(csv.DictReader(file))


LIMITS = read_limits()


def named(row: dict[str, str]) -> str:
    return f"{row['scene']} {row['shape']} {row['transfer']} {row['criterion']}"


def sets_of(row: dict[str, str]) -> list[str]:
    return [f"method.shape={row['shape']}", f"method.transfer={transfer_value(row['transfer'])}"]


def is_stable(row: dict[str, str], courant: float) -> bool:
    def trial(courant: float) -> dict:
        scene = str(INPUTS / f"{row['scene']}.yaml")
        job = {"scene": scene, "sets": sets_of(row), "courant": courant, "threads": 1, "bound": 0.05}
        return run_trial(job)

    found = trial(courant)
    if not found["bounded"] or row["criterion"] == "bounded":
        return found["bounded"]
    return found["loss"] <= trial(0.5 * courant)["loss"] + LOSS


def limit_of(transfer: str, shape: str = "lcpdi", criterion: str = "bounded") -> float:
    (found,) = [
        float(row["stable"])
        for row in LIMITS
        if (row["scene"], row["shape"], row["transfer"], row["criterion"])
        == ("vibrating_bar", shape, transfer, criterion)
    ]
    return found


def blended(order: int, fraction: float) -> str:
    return f"{{kind: fmpm, order: 40, blend: {{order: {order}, fraction: {fraction}}}}}"


FIG_12A = [
    ("flip", 0.85, 0.02),
    ("fmpm:2", 0.685, 0.015),
    ("fmpm:4", 0.541, 0.015),
    ("fmpm:8", 0.41, 0.015),
    ("fmpm:16", 0.323, 0.015),
    ("fmpm:40", 0.255, 0.025),
    ("fmpm:80", 0.255, 0.025),
    (blended(1, 0.8), 0.52, 0.02),
    (blended(1, 0.9), 0.41, 0.02),
    (blended(2, 0.8), 0.41, 0.02),
]


@pytest.mark.parametrize(("transfer", "published", "within"), FIG_12A)
def test_measured_limits_are_those_published(transfer, published, within):
    assert limit_of(transfer) == pytest.approx(published, abs=within)


@pytest.mark.slow
def test_a_blend_with_order_two_loses_next_to_nothing():
    sets = [f"method.transfer={blended(2, 0.8)}"]
    job = {"scene": str(INPUTS / "vibrating_bar.yaml"), "sets": sets, "threads": 1, "bound": 0.05}
    assert 0.0 < run_trial(job | {"courant": limit_of(blended(2, 0.8))})["loss"] < 0.01


def test_periodic_fmpm_as_published():
    transfer = "{kind: fmpm, order: 80, every_courant: 2}"
    assert limit_of(transfer, criterion="accurate") == pytest.approx(0.41, abs=0.0301)


AGAIN = {
    "flip",
    "fmpm:4",
    "fmpm:16",
    blended(1, 0.8),
    blended(2, 0.8),
    "{kind: fmpm, order: 80, every_courant: 2}",
}
MARKED = [
    pytest.param(row, id=named(row), marks=pytest.mark.slow if row["shape"] == "lcpdi" else pytest.mark.long)
    for row in LIMITS
    if row["scene"] == "vibrating_bar" and row["transfer"] in AGAIN
] + [
    pytest.param(row, id=named(row), marks=pytest.mark.long)
    for row in LIMITS
    if row["scene"] != "vibrating_bar" and row["transfer"] == "fmpm:4"
]


@pytest.mark.parametrize("row", MARKED)
def test_the_limit_is_still_there(row):
    limit, resolution = float(row["stable"]), float(row["resolution"])
    assert is_stable(row, limit - 2 * resolution)
    assert not is_stable(row, limit + 3 * resolution)


@pytest.mark.parametrize("row", LIMITS, ids=named)
@pytest.mark.slow
def test_the_chosen_step_is_stable(row):
    """``courant: auto`` is below the limit, by 40 % at most but with velocity gradients."""
    scene = load_scene(INPUTS / f"{row['scene']}.yaml", sets=[*sets_of(row), "time.courant=auto"]).scene
    share = chosen_courant(scene) / float(row["stable"])
    assert (0.28 if "velocity_gradient" in row["transfer"] else 0.6) < share < 1.0


BARS = [row for row in LIMITS if row["scene"] == "vibrating_bar" and "order: 8" not in row["transfer"]]


@pytest.mark.parametrize("row", BARS, ids=named)
@pytest.mark.slow
def test_predicted_limits_of_the_bar(row):
    scene = load_scene(INPUTS / "vibrating_bar.yaml", sets=sets_of(row)).scene
    within = (
        0.2 if row["shape"] == "ugimp" else 0.09
    )  # the end of the bar turns more slowly than the block moves
    assert limit_in_motion(scene) == pytest.approx(float(row["stable"]), rel=within)


@pytest.mark.slow
def test_usavg_keeps_the_energy_that_usl_trebles():
    """FMPM(4) with velocity gradients over 16 periods, far below the limit of five."""

    def excess(update: str) -> tuple[float, float]:
        transfer = "method.transfer={kind: fmpm, order: 4, velocity_gradient: true}"
        job = {"scene": str(INPUTS / "vibrating_bar.yaml"), "sets": [transfer, f"method.update={update}"]}
        found = run_trial(job | {"courant": 0.4, "until": 16 * 80.0, "threads": 1, "bound": 0.05})
        return found["excess"], found["loss"] or 0.0

    assert excess("usl")[0] > 0.5
    most, lost = excess("usavg")
    assert most < 0.002
    assert abs(lost) < 0.005
