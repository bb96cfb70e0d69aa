"""Draws the picture of ``inputs/ellipse_compaction.yaml``: 20 ellipses that lie in a box as chance has put them.

``python docs/draw_ellipses.py`` writes ``inputs/ellipse_compaction.png``, the same bits every time. The first ellipses
are the largest. Each goes to the first of many random places and directions where it touches none before it.
"""

from __future__ import annotations

import math
import random
from pathlib import Path

import numpy as np
from PIL import Image

WIDTH, HEIGHT = 280, 560
"""Pixels of the box, 1 mm × 2 mm; twice as many per axis as particles."""

COUNT = 20
"""Ellipses; the grey level of number i is ``STEP`` times i + 1."""

STEP = 10
"""Between the grey levels of two ellipses."""

LARGEST, SMALLEST = 9200.0, 2000.0
"""Areas of the first and the last ellipse, in pixels."""

TRIES = 200_000
"""Places looked at for one ellipse."""

SEED = 2020
"""Start of the random numbers."""


def draw() -> np.ndarray:
    """Grey levels (HEIGHT, WIDTH), the first row at the top; 255 between the ellipses."""
    numbers = random.Random(SEED)  # whose ``random()`` gives the same numbers in every version of Python
    x, y = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    levels = np.full((HEIGHT, WIDTH), 255, dtype=np.uint8)
    for i in range(COUNT):
        area = LARGEST * (SMALLEST / LARGEST) ** (i / (COUNT - 1))
        aspect = 1.0 + numbers.random()
        radius = math.sqrt(area / math.pi)
        long, short = radius * math.sqrt(aspect), radius / math.sqrt(aspect)
        for _ in range(TRIES):
            at_x, at_y = WIDTH * numbers.random(), HEIGHT * numbers.random()
            angle = math.pi * numbers.random()
            c, s = math.cos(angle), math.sin(angle)
            reach_x, reach_y = math.hypot(long * c, short * s), math.hypot(long * s, short * c)
            if not (reach_x < at_x < WIDTH - reach_x and reach_y < at_y < HEIGHT - reach_y):
                continue
            low, high = int(at_y - reach_y), int(at_y + reach_y) + 1
            left, right = int(at_x - reach_x), int(at_x + reach_x) + 1
            box = slice(max(low - 1, 0), high + 1), slice(max(left - 1, 0), right + 1)
            dx, dy = x[box] - at_x, y[box] - at_y
            inside = ((c * dx + s * dy) / long) ** 2 + ((c * dy - s * dx) / short) ** 2 <= 1.0
            if (levels[box][inside] == 255).all():
                levels[box][inside] = STEP * (i + 1)
                break
        else:
            raise RuntimeError(f"found no place for ellipse {i + 1} of {COUNT}")
    return levels


if __name__ == "__main__":
    path = Path(__file__).parents[1] / "inputs" / "ellipse_compaction.png"
    Image.fromarray(draw()).save(path, optimize=True)
