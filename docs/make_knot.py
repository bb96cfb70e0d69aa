"""Write the closed surface of a trefoil knot, the STL file of the template ``mesh_3d``.

python docs/make_knot.py [mpmcli/scene/templates/mesh_3d.stl]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

FILE = Path(__file__).parents[1] / "mpmcli" / "scene" / "templates" / "mesh_3d.stl"
ALONG, AROUND = 72, 10
RADIUS = 0.6
"""Of the tube; the knot itself lies within 3.6 of its centre."""


def tube() -> np.ndarray:
    """Corners on the tube [ALONG, AROUND, 3], its axis the knot (sin t + 2 sin 2t, cos t − 2 cos 2t, −sin 3t)."""
    t = np.linspace(0, 2 * np.pi, ALONG, endpoint=False)
    axis = np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=1)
    along = np.stack(
        [np.cos(t) + 4 * np.cos(2 * t), -np.sin(t) + 4 * np.sin(2 * t), -3 * np.cos(3 * t)], axis=1
    )
    along /= np.linalg.norm(along, axis=1)[:, None]
    first = np.cross(along, [0.0, 0.0, 1.0])  # the tangent is never along z
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(along, first)
    angle = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)[:, None]
    circle = np.cos(angle) * first[:, None] + np.sin(angle) * second[:, None]
    return axis[:, None] + RADIUS * circle


def triangles(corners: np.ndarray) -> np.ndarray:
    """Two triangles [n, 3, 3] for each quadrilateral of the tube, seen from outside counterclockwise."""
    across = np.roll(corners, -1, axis=0)
    around = np.roll(corners, -1, axis=1)
    opposite = np.roll(across, -1, axis=1)
    pairs = np.stack([np.stack([corners, across, opposite], 2), np.stack([corners, opposite, around], 2)], 2)
    return pairs.reshape(-1, 3, 3)


def write(path: Path) -> None:
    """Write a binary STL file."""
    t = triangles(tube())
    record = np.zeros(len(t), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    normal = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    record["normal"] = normal / np.linalg.norm(normal, axis=1)[:, None]
    record["corners"] = t
    header = b"trefoil knot, made by docs/make_knot.py of mpmcli".ljust(80)
    path.write_bytes(header + len(t).to_bytes(4, "little") + record.tobytes())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else FILE)
