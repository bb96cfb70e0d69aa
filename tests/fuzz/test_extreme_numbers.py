"""Every number of every material takes extreme values: exit codes 0, 3 and 4 only, and no warnings on the screen."""

import math
import os
from collections import Counter
from pathlib import Path
from typing import Any

import examples
import numpy as np
import pytest
import yaml
from commands import answered
from numbers_of_scenes import numbers_in, with_number

from mpmcli.materials import MATERIALS

EXTREMES = [0, -0.0, 5e-324, 1e-99, 1e-50, 1e-12, 1e-6, 1e6, 1e12, 1e50, 1e99, 1e300, -1, math.inf, math.nan]
"""Zero, numbers that materials may have, and some that they may not."""
TRIED = int(os.environ.get("MPMCLI_EXTREMES", "40"))
"""Scenes per material that run, of several hundred."""
SECONDS = 30.0
"""Nearly all of it to compile."""


def scene_of(material: dict[str, Any]) -> dict[str, Any]:
    """Four particles in plane strain that are sheared and pressed."""
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [0, 0], "upper": [3, 3], "cell": 1},
        "materials": {"m": material},
        "bodies": [
            {
                "name": "b",
                "material": "m",
                "particles_per_axis": 2,
                "velocity": ["0.01*y", "-0.02*y"],
                "region": {"kind": "box", "lower": [1, 1], "upper": [2, 2]},
            }
        ],
        "time": {"end": 1, "max_steps": 3},
        "archive": {"globals": {"every": 0.5}},
    }


def ways(kind: str) -> list[dict[str, Any]]:
    """The material with one, or with two numbers at an extreme, in any order that is always the same."""
    found = []
    rng = np.random.default_rng(7)
    for numbers in examples.MATERIALS[kind]:
        keys = examples.material(kind, numbers)
        paths = list(numbers_in(keys))
        for path in paths:
            for value in EXTREMES:
                one = with_number(keys, path, value)
                found += [
                    one,
                    with_number(one, paths[rng.integers(len(paths))], EXTREMES[rng.integers(len(EXTREMES))]),
                ]
    return [found[i] for i in rng.permutation(len(found))]


@pytest.mark.slow
@pytest.mark.parametrize("kind", [kind for kind in MATERIALS if kind != "rigid"])
def test_extreme_numbers_of_materials(kind: str, tmp_path: Path, monkeypatch):
    monkeypatch.setenv("MPMCLI_DEBUG", "1")
    path = tmp_path / "scene.yaml"
    findings = []
    codes: Counter[int] = Counter()
    tried = ways(kind)[:TRIED]
    for keys in tried:
        path.write_text(yaml.safe_dump(scene_of(keys)), encoding="utf-8")
        code, wrong = answered(["validate", str(path)], {0, 3}, SECONDS)
        if not wrong and code == 0:
            command = ["run", str(path), "-o", str(tmp_path / "out"), "--overwrite", "--quiet"]
            code, wrong = answered(command, {0, 3, 4}, SECONDS)
        codes[code] += 1
        if wrong:
            findings.append(f"{keys}: {wrong}")
    assert findings == []
    assert codes[0] + codes[4] > 0.1 * len(tried)
