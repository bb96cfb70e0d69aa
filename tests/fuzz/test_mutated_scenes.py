"""Every scene of ``inputs/``, changed at random: answered in words and quickly, run or refused, never a fault of ours.

The same cases every time: 300 in CI, run as long as ``BUDGET`` lasts, and ``MPMCLI_MUTATIONS`` (10,000) in the long
test, which prints how many ended with which exit code. Its parts, and the scenes that should not have ended so, are
kept in the folder ``MPMCLI_CAMPAIGN``: what was counted there is not taken again, so that a cut loses one part at most.
"""

import contextlib
import copy
import json
import math
import os
import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from commands import spoken, unfit
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from mpmcli.scene.loader import load_scene
from mpmcli.scene.tree import compose

ROOT = Path(__file__).parents[2]
SCENES = sorted([*ROOT.glob("inputs/*.yaml"), *ROOT.glob("mpmcli/scene/templates/*.yaml")])
SMALLER = {"sphere_collision_3d": 2.0, "ellipse_compaction": 0.1, "kirsch_plate": 0.5, "two_disks": 1.0}
SMALLER |= {"block_impact": 2.0, "stretched_bar": 0.5, "shock_nickel": 0.5, "shock_interface": 0.5}
"""Cells with which the larger scenes are quick."""
MOST_PARTICLES = 20_000
SECONDS_TO_VALIDATE = 10.0
SECONDS_TO_RUN = 120.0
"""Nearly all of it to compile what no case before has used."""
BUDGET = 90.0
"""Seconds of processor time that CI spends on running cases, mostly on compiling; the rest it only validates."""
ALLOWED = {0, 3, 4}
PARTS = 20
"""Of the long test."""

JUNK = [
    *(None, True, 0, -1, 1e-300, 1e300, math.inf, math.nan, 10**30, "x", "", "1 GPa", "9**9**9"),
    *("1e308*10", "1/0", "t", "x*y", "log(-x)", "é" * 200, "\0", "lambda: 0", "__import__('os')"),
    *("a: b", "\n", "9" * 5000, [], {}, [1], [1, 2, 3, 4, 5], [[1]], {"kind": "box"}, {"a": 1}),
    *(["1e9", "1e9"], {"name": "x"}),
]
HOSTILE = [
    *("1e99999999 GPa", "1e-99999999 m", "0e999999999 s", "1e400", 1e308, -1e308, 5e-324, 1e-20),
    *(10**9, 10**19, "9" * 1990, "1 ((km^9)^9)^9", "1 m²³²³²³", "1e300 Ym^9", "1e99999999 m/s"),
    *("-1e9999999999999999999 K", "/dev/zero", "/dev/urandom", "/dev/stdin", "/proc/self/mem"),
    *("a_pipe", "hostile.csv"),
]
"""Numbers and names of files that look well and are not."""
VOLUMES = ["1", "1e-320", "1e300", "nan", "-1", "0", "9" * 400, "x", ""]
"""Of a particle in ``hostile.csv``."""
MANY = 300
"""Copies of a member of a list, with the same faults as it has."""
FACTORS = [0.0, -1.0, 0.5, 2.0, 3.0, 1e3, 1e-3, 1e-9, 1e9, 1e30, 1e-30, 1e200, 1.0000001]
MARKS = "[]{}:,'\"&*!|>%@`\t\n#-? \0\ufeff\x85é"
WAYS = ("drop", "retype", "swap", "scale", "rename", "nest", "graft", "hostile", "many", "points")

Path_ = tuple[Any, ...]


def read(path: Path) -> Any:
    """A scene as plain values, small enough to run in no time."""
    scene = compose(path.read_text(encoding="utf-8"), path.name).plain()
    if path.stem in SMALLER:
        scene["grid"]["cell"] = SMALLER[path.stem]
    return scene


def places_in(value: Any, place: Path_ = ()) -> Iterator[Path_]:
    """Where everything in a plain value stands."""
    members: Any = ()
    if isinstance(value, dict):
        members = value.items()
    elif isinstance(value, list):
        members = enumerate(value)
    for key, member in members:
        yield (*place, key)
        yield from places_in(member, (*place, key))


def at(value: Any, place: Path_) -> Any:
    """What stands at a place."""
    for key in place:
        value = value[key]
    return value


WHOLE = [read(path) for path in SCENES]
KNOWN: dict[Any, list[Any]] = {}
"""Values that some scene has, by their keys: what fits a place, but perhaps not its surroundings."""
for whole in WHOLE:
    for where in places_in(whole):
        if isinstance(where[-1], str):
            KNOWN.setdefault(where[-1], []).append(at(whole, where))
KNOWN["shape"] = ["linear", "ugimp", "lcpdi", "bspline2", "b2gimp", "b2cpdi"]
KNOWN["update"] = ["usf", "usl", "usl+", "usavg", "usavg+"]


def mutate(scene: Any, way: str, draw: Any) -> None:
    """Change one thing in a scene."""
    everything = list(places_in(scene))
    if not everything:
        return
    place = draw(st.sampled_from(everything))
    parent, key = at(scene, place[:-1]), place[-1]
    if way == "drop":
        del parent[key]
    elif way == "retype":
        parent[key] = copy.deepcopy(draw(st.sampled_from(JUNK)))
    elif way == "swap":
        other = draw(st.sampled_from(everything))
        here, there = copy.deepcopy(parent[key]), copy.deepcopy(at(scene, other))
        at(scene, other[:-1])[other[-1]] = here
        if place[:-1] == other[: len(place) - 1] or other[: len(place)] != place:
            with contextlib.suppress(KeyError, IndexError, TypeError):
                at(scene, place[:-1])[key] = there
    elif way == "scale":
        numbers = [p for p in everything if isinstance(at(scene, p), int | float)]
        if numbers:
            place = draw(st.sampled_from(numbers))
            value, factor = at(scene, place), draw(st.sampled_from(FACTORS))
            product = value * factor
            is_whole = isinstance(value, int) and math.isfinite(product) and product.is_integer()
            at(scene, place[:-1])[place[-1]] = int(product) if is_whole else product
    elif way == "rename" and isinstance(parent, dict):
        name = draw(st.sampled_from([f"{key}x", f"{key}"[:-1], str(key).upper(), *map(str, KNOWN)]))
        parent[name] = parent.pop(key)
    elif way == "nest":
        value = parent[key]
        inner = list(value.values()) if isinstance(value, dict) else value
        wrapped = [{"a": value}, [value], [value, value], {key: value}]
        if isinstance(inner, list) and inner:
            wrapped.append(inner[0])
        parent[key] = draw(st.sampled_from(wrapped))
    elif way == "hostile":
        parent[key] = draw(st.sampled_from(HOSTILE))
    elif way == "many":
        lists = [p for p in everything if isinstance(at(scene, p), list) and at(scene, p)]
        if lists:
            members = at(scene, draw(st.sampled_from(lists)))
            member = draw(st.sampled_from(members))
            members += [copy.deepcopy(member) for _ in range(MANY)]
    elif way == "points" and scene.get("bodies") and isinstance(scene["bodies"], list):
        body = draw(st.sampled_from(scene["bodies"]))
        if isinstance(body, dict):
            body["region"] = {"kind": "points", "file": "hostile.csv"}
    elif way == "graft" and key in KNOWN:
        parent[key] = copy.deepcopy(draw(st.sampled_from(KNOWN[key])))


@st.composite
def mutated_scenes(draw: Any) -> str:
    """Text of a scene in which one to three things were changed."""
    scene = copy.deepcopy(draw(st.sampled_from(WHOLE)))
    for _ in range(draw(st.sampled_from([1, 1, 1, 1, 2, 2, 3]))):
        mutate(scene, draw(st.sampled_from(WAYS)), draw)
    text = str(yaml.dump(scene, Dumper=Dumper, allow_unicode=True, width=10**9))
    if draw(st.integers(0, 19)) == 19:  # a bomb of merged mappings
        keys = ", ".join(f"k{i}: 1" for i in range(draw(st.sampled_from([10, 200, 900]))))
        text += f"bomb:\n  - &bomb {{{keys}}}\n" + "  - {<<: *bomb}\n" * draw(st.sampled_from([2, 900]))
    if draw(st.integers(0, 9)) == 9:  # garble
        place = draw(st.integers(0, len(text)))
        put = draw(st.text(MARKS, max_size=3))
        text = text[:place] + put + text[place + draw(st.integers(0, 8)) :]
    return text


class Dumper(yaml.SafeDumper):
    """Writes equal values out each time."""

    def ignore_aliases(self, data: Any) -> bool:
        """No aliases."""
        return True


def most_particles(path: Path) -> float:
    """How many particles a valid scene has at most."""
    scene = load_scene(path, allow_outside_files=True).scene
    grid, total = scene.grid, 0.0
    for body in scene.bodies:
        lower, upper = (np.array(corner) for corner in body.region.bounds(grid.dimensions))
        extent = np.minimum(upper, grid.upper) - np.maximum(lower, grid.lower)
        with np.errstate(over="ignore"):
            total += float(np.prod(np.maximum(extent, 0) / grid.cell * np.array(body.particles_per_axis) + 1))
    return total


class Trial:
    """Takes cases, in a folder of its own."""

    def __init__(self, folder: Path, budget: float):
        self.folder = folder
        self.budget = budget
        self.codes: dict[str, Counter[Any]] = {"validate": Counter(), "run": Counter()}
        self.slowest = 0.0
        for picture in (ROOT / "inputs").glob("*.png"):
            shutil.copy(picture, folder)
        if not (folder / "a_pipe").exists():
            os.mkfifo(folder / "a_pipe")
        self.taken = 0

    def summary(self) -> str:
        """How many cases ended with which exit code."""
        counts = [
            f"{c}: {sum(n.values())} scenes, exit codes {dict(sorted(n.items()))}"
            for c, n in self.codes.items()
        ]
        return "; ".join([*counts, f"slowest validation {self.slowest:.3g} s"])

    def take(self, text: str) -> str:
        """Validate a scene, and run five steps of a small one; what is wrong with how that went, in words."""
        path = self.folder / "scene.yaml"
        path.write_text(text, encoding="utf-8")
        volume = VOLUMES[self.taken % len(VOLUMES)]
        self.taken += 1
        (self.folder / "hostile.csv").write_text(f"x,y,z,volume\n0,0,0,0.01\n0.1,0.1,0.1,{volume}\n")
        code, written, seconds = spoken(["validate", "--allow-outside-files", str(path)])
        self.slowest = max(self.slowest, seconds)
        self.codes["validate"][code] += 1
        if code not in (0, 3) or seconds > SECONDS_TO_VALIDATE:
            return f"validate: exit code {code} after {seconds:.3g} s\n{written}"
        if wrong := unfit(code, written):
            return f"validate: {wrong}\n{written}"
        if code or self.budget <= 0.0 or most_particles(path) > MOST_PARTICLES:
            return ""
        results = self.folder / "results"
        options = ["--set", "time.max_steps=5", "--allow-outside-files", "--threads", "1", "-o", str(results)]
        code, written, seconds = spoken(["run", str(path), *options])
        self.codes["run"][code] += 1
        self.budget -= seconds
        shutil.rmtree(results, ignore_errors=True)
        wrong = unfit(code, written)
        if code not in ALLOWED or seconds > SECONDS_TO_RUN or wrong:
            return f"run: exit code {code} after {seconds:.3g} s {wrong}\n{written}"
        return ""


@pytest.fixture
def trial(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Trial:
    """A fresh one, whose faults show where they are."""
    monkeypatch.setenv("MPMCLI_DEBUG", "1")
    return Trial(tmp_path, getattr(request, "param", math.inf))


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of what the long test found."""
    folder = Path(os.environ.get("MPMCLI_CAMPAIGN") or tmp_path_factory.mktemp("campaign"))
    folder.mkdir(parents=True, exist_ok=True)
    return folder


HEALTH = [
    HealthCheck.too_slow,
    HealthCheck.data_too_large,
    HealthCheck.function_scoped_fixture,
    HealthCheck.large_base_example,
]


@pytest.mark.parametrize("trial", [0.0, pytest.param(BUDGET, marks=pytest.mark.slow)], indirect=True)
@settings(max_examples=300, database=None, suppress_health_check=HEALTH)
@given(text=mutated_scenes())
def test_mutated_scenes(trial: Trial, text: str) -> None:
    assert not trial.take(text)


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("part", range(PARTS))
def test_ten_thousand_mutated_scenes(trial: Trial, part: int, kept: Path) -> None:
    counted = kept / f"part_{part:02}.json"
    findings: list[str] = []

    @seed(part)
    @settings(
        max_examples=int(os.environ.get("MPMCLI_MUTATIONS", "10000")) // PARTS,
        database=None,
        suppress_health_check=HEALTH,
    )
    @given(text=mutated_scenes())
    def take_all(text: str) -> None:
        words = trial.take(text)
        if words:
            findings.append(words)
            name = f"finding_{part:02}_{len(findings)}"
            (kept / f"{name}.yaml").write_text(text, encoding="utf-8")
            (kept / f"{name}.txt").write_text(words, encoding="utf-8")

    if not counted.exists():
        take_all()
        counts = {command: dict(codes) for command, codes in trial.codes.items()}
        counted.write_text(json.dumps(counts | {"slowest": trial.slowest, "findings": findings}))
    total = Trial(trial.folder, 0.0)
    for path in kept.glob("part_*.json"):
        counts = json.loads(path.read_text())
        total.slowest = max(total.slowest, counts["slowest"])
        for command, codes in total.codes.items():
            codes.update({int(code): number for code, number in counts[command].items()})
    print(f"after part {part}: {total.summary()}", flush=True)
    findings = json.loads(counted.read_text())["findings"]
    assert not findings, f"{len(findings)} findings in {kept}, the first:\n{findings[0]}"
