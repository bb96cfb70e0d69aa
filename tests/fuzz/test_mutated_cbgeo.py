"""Inputs of CB-Geo changed at random: translated or refused in words, never a fault of ours."""

import copy
import json
import os
from collections import Counter
from typing import Any

import numpy as np
import pytest
from commands import spoken, unfit
from outside.cbgeo.sources import BENCHMARKS, Benchmark, absorbing_column

CASES = int(os.environ.get("MPMCLI_MUTATIONS", "300"))
"""Of the slow test."""
MADE = {**BENCHMARKS, "small_absorbing": lambda: absorbing_column(5)}
SMALL = [
    "moved_particles",
    "sliding_block",
    "small_absorbing",
    "uniaxial_stress_3d",
    "uniaxial_traction",
    "uniaxial_traction_file",
]
JUNK = [
    *(None, True, 0, -1, 1, 3, 99, 1.5, 1e-300, 1e300, 10**30, "x", "", "../x", "mesh.txt", "\0"),
    *([], {}, [1], [[]], {"id": 0}, [{}], "9" * 5000, ["a"] * 3),
    *("Linear", "gauss", "file", "NorSand2D", "MohrCoulomb2D", "ED2Q16G"),
]
WORDS = ["", "x", "-1", "1e400", "nan", "0", "9999999999", "0.05", "!", "#", "1 2 3 4 5", "\0", "é", "1e-320"]


def paths(node: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Every place in a tree."""
    found = [at] if at else []
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, member in items:
        found += paths(member, (*at, key))
    return found


def changed(given: Benchmark, random: np.random.Generator) -> Benchmark:
    """A copy with one or two changes of the main file or of the others."""
    made = Benchmark(given.folder, copy.deepcopy(given.main), dict(given.files))
    for _ in range(random.integers(1, 3)):
        if random.random() < 0.6:
            change_tree(made.main, random)
        else:
            name = sorted(made.files)[random.integers(len(made.files))]
            made.files[name] = changed_text(made.files[name], random)
    return made


def change_tree(tree: dict[str, Any], random: np.random.Generator) -> None:
    """Set, take away, rename or copy one member."""
    places = paths(tree)
    *above, key = places[random.integers(len(places))]
    node: Any = tree
    for part in above:
        node = node[part]
    how = random.integers(5)
    if how == 0:
        del node[key]
    elif how == 1 and isinstance(node, dict):
        node[f"{key}s"] = node.pop(key)
    elif how == 2 and isinstance(node, list):
        node.append(copy.deepcopy(node[key]))
    else:
        node[key] = copy.deepcopy(JUNK[random.integers(len(JUNK))])


def changed_text(text: str, random: np.random.Generator) -> str:
    """Change a line, a word or the length of a file."""
    lines = text.splitlines()
    if not lines:
        return "1"
    at, how = random.integers(len(lines)), random.integers(4)
    if how == 0:
        del lines[at]
    elif how == 1:
        lines.insert(at, lines[random.integers(len(lines))])
    elif how == 2:
        return text[: random.integers(len(text))]
    else:
        words = lines[at].split()
        if words:
            words[random.integers(len(words))] = WORDS[random.integers(len(WORDS))]
        lines[at] = "\t".join(words)
    return "\n".join(lines) + "\n"


def run_cases(count: int, seed: int, tmp_path: Any) -> Counter[int]:
    """Import changed inputs; how often each exit code came."""
    random = np.random.default_rng(seed)
    codes: Counter[int] = Counter()
    for case in range(count):
        made = changed(MADE[SMALL[case % len(SMALL)]](), random)
        folder = tmp_path / str(case)
        folder.mkdir()
        for name, text in made.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        source = folder / "mpm.json"
        source.write_text(json.dumps(made.main))
        partial = ["--partial"] if case % 3 == 0 else []
        code, written, seconds = spoken(
            ["import", "cbgeo", str(source), "-o", str(folder / "scene.yaml"), *partial]
        )
        assert code in {0, 3}, (case, code, written)
        assert not unfit(code, written), (case, written)
        assert seconds < 20.0, (case, seconds)
        codes[code] += 1
    return codes


def test_changed_inputs(tmp_path):
    codes = run_cases(40, 1, tmp_path)
    assert codes[3]


@pytest.mark.slow
def test_more_changed_inputs(tmp_path):
    codes = run_cases(CASES, 2, tmp_path)
    assert codes[0]
    assert codes[3]
