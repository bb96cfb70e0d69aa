"""Time to find the normal of a contact: per node, and per pass of the regressions.

    python benchmarks/contact_normals.py [--nodes N] [--repeats N] [--json FILE]

Neighbours are jittered lattices, 16 particles in 2D and 64 in 3D, cut by planes of random directions. One thread, its
own processor time; all kinds and the calibration loop are measured in turn, and again, and medians are printed. The
aim is 105 ns per pass of the logistic regression with 16 particles.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import time
from pathlib import Path
from typing import Any

from calibration import Calibration, numba

import numpy as np  # isort: skip

from mpmcli.contact.neighbours import WORK, Neighbours
from mpmcli.contact.normals import NORMALS, find_normal
from mpmcli.contact.normals.plane import fit_plane
from mpmcli.core.compiled.kernel import kernel

ITERATED = ("logistic_regression", "irls")


@kernel
def find_normals(normal, axes, x, side, S, G, volume, work, guess, out):
    """One normal per node k: ``x`` (nodes, d, n), ``side`` (nodes, n), …, ``out`` (nodes, d)."""
    for k in numba.prange(out.shape[0]):
        neighbours = Neighbours(x[k], side[k], S[k], G[k], volume[k], volume[k], None, None, work[k])
        find_normal(normal, axes, neighbours, side.shape[1], 0.0, 1.0, guess[k], out[k])


@kernel
def count_passes(normal, axes, x, side, S, G, volume, work, guess, passes):
    """Passes of a regression at each node, (nodes,)."""
    for k in numba.prange(passes.shape[0]):
        neighbours = Neighbours(x[k], side[k], S[k], G[k], volume[k], volume[k], None, None, work[k])
        _, passes[k], _ = fit_plane(normal, axes, neighbours, side.shape[1], guess[k])


def make_neighbours(d: int, nodes: int) -> tuple[np.ndarray, ...]:
    """Positions, sides, S, G and volumes of the particles around ``nodes`` nodes at 0, in cells."""
    rng = np.random.default_rng(d)
    lattice = np.array(np.meshgrid(*[[-0.75, -0.25, 0.25, 0.75]] * d, indexing="ij")).reshape(d, -1)
    x = lattice + rng.uniform(-0.1, 0.1, (nodes, d, 4**d))
    n = rng.normal(size=(nodes, d))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    t = np.einsum("ka,kap->kp", n, x) - rng.uniform(-0.2, 0.2, (nodes, 1))
    hats = np.maximum(1 - abs(x), 0)
    G = -np.sign(x) * np.stack([np.prod(np.delete(hats, a, axis=1), axis=1) for a in range(d)], axis=1)
    return x, np.where(t < 0, -1.0, 1.0), np.prod(hats, axis=1), G, np.full((nodes, 4**d), 0.5**d)


class Case:
    """One kind in one dimension, with the samples taken of it."""

    def __init__(self, kind: str, d: int, nodes: int, reuse: bool = False):
        self.name = f"{d}D {kind}" + (" reuse" if reuse else "")
        keys = {"kind": kind} | ({"reuse": True} if reuse else {})
        normal = NORMALS[kind].model_validate(keys).parameters(d, (1.0,) * d)  # type: ignore[attr-defined]
        self.out = np.zeros((nodes, d))
        neighbourhoods = make_neighbours(d, nodes)
        self.arguments: tuple[Any, ...] = (
            normal, (0.0,) * d, *neighbourhoods, np.zeros((nodes, WORK)), np.zeros((nodes, d)),
        )  # fmt: skip
        self.passes = 1.0
        find_normals[False](*self.arguments, self.out)
        if reuse:
            self.arguments = (*self.arguments[:-1], self.out.copy())
        if kind in ITERATED:
            passes = np.zeros(nodes, dtype=np.int64)
            count_passes[False](*self.arguments, passes)
            self.passes = float(passes.mean())
        self.samples: list[float] = []

    def measure(self) -> None:
        """Take one sample: nanoseconds per node."""
        begin = time.thread_time()
        find_normals[False](*self.arguments, self.out)
        self.samples.append((time.thread_time() - begin) / len(self.out) * 1e9)


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description="Time to find contact normals.")
    parser.add_argument("--nodes", type=int, default=1000)
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--json", type=Path, help="write all figures to this file")
    options = parser.parse_args()
    kinds = [kind for kind in NORMALS if kind != "specified"]
    cases = [Case(kind, d, options.nodes) for d in (2, 3) for kind in kinds]
    cases += [Case("logistic_regression", d, options.nodes, reuse=True) for d in (2, 3)]
    calibration = Calibration()
    for _ in range(options.repeats):
        calibration.measure(1)
        for case in cases:
            case.measure()
    operation = statistics.median(calibration.arithmetic[1])
    print(f"load {os.getloadavg()[0]:.1f}, {operation:.2f} ns per operation in a chain")
    print(f"{'kind':<36}{'passes':>8}{'ns/node':>10}{'ns/pass':>10}")
    for case in cases:
        median = statistics.median(case.samples)
        print(f"{case.name:<36}{case.passes:>8.2f}{median:>10.0f}{median / case.passes:>10.0f}")
    if options.json:
        figures = {case.name: {"passes": case.passes, "ns_per_node": case.samples} for case in cases}
        options.json.write_text(json.dumps({"ns_per_operation": operation, "cases": figures}, indent=1))


if __name__ == "__main__":
    main()
