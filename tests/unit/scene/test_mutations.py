"""Scenes changed at random are read or refused in words, quickly, and nothing else happens."""

from __future__ import annotations

import copy
import math
import random
import time
from pathlib import Path
from typing import Any

import pytest
import yaml

from mpmcli.core.errors import SceneError
from mpmcli.scene.loader import load_scene
from mpmcli.scene.tree import compose

ROOT = Path(__file__).parents[3]
SCENES = sorted([*ROOT.glob("inputs/*.yaml"), *ROOT.glob("mpmcli/scene/templates/*.yaml")])
JUNK = [None, True, 0, -1, math.inf, math.nan, "x", "", "1 GPa", "9**9**9", "1/0", "t", 10**30, "é" * 200]
JUNK += [[], {}, [1], [1, 2, 3, 4, 5], {"kind": "box"}, {"a": 1}, [[1]], "a: b", "\n"]
MARKS = "[]{}:,'\"&*!|>%@`\t\n#-"


def paths(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths of everything in a plain value."""
    members = (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    )
    return [path, *(inner for key, member in members for inner in paths(member, (*path, key)))]


def at(value: Any, path: tuple[Any, ...]) -> Any:
    """What stands at a path."""
    for key in path:
        value = value[key]
    return value


def mutate(scene: Any, choose: random.Random) -> str:
    """Drop, replace, swap, rename, scale, nest or garble some members; the result as YAML."""
    scene = copy.deepcopy(scene)
    for _ in range(choose.randint(1, 4)):
        everything = [path for path in paths(scene) if path]
        path = choose.choice(everything)
        parent, key = at(scene, path[:-1]), path[-1]
        match choose.randrange(6):
            case 0 if len(everything) > 1:
                del parent[key]
            case 1:
                parent[key] = copy.deepcopy(choose.choice(JUNK))
            case 2:
                parent[key] = copy.deepcopy(at(scene, choose.choice(everything)))
            case 3 if isinstance(parent, dict):
                parent[f"{key}{choose.choice('x_')}"] = parent.pop(key)
            case 4 if isinstance(parent[key], int | float):
                parent[key] *= choose.choice([0, -1, 1e3, 1e-9, 1e30, 0.5])
            case _:
                parent[key] = choose.choice([{"a": parent[key]}, [parent[key]]])
    text = yaml.safe_dump(scene, allow_unicode=True)
    if choose.random() < 0.2:
        place = choose.randint(0, len(text))
        text = text[:place] + choose.choice(MARKS) + text[place + choose.randint(0, 3) :]
    return text + "\n"


@pytest.mark.parametrize("seeds", [range(12), pytest.param(range(12, 40), marks=pytest.mark.slow)], ids=str)
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_mutated_scenes(path: Path, seeds: range) -> None:
    scene = compose(path.read_text(encoding="utf-8"), path.name).plain()
    for seed in seeds:
        text = mutate(scene, random.Random(f"{path.stem} {seed}"))
        begin = time.perf_counter()
        try:
            assert load_scene(text).hash
        except SceneError as error:
            messages = [problem.message for problem in error.problems]
            assert all(messages)
            assert not [m for m in messages if "Input should" in m or "validation error" in m]
        assert time.perf_counter() - begin < 10.0, f"seed {seed} took too long"
