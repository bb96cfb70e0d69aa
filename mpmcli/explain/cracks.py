"""What cracks will do in a run: chains, nodes with several sides, cut particles, domains of tips, memory."""

import math
from typing import Any

import numpy as np

from mpmcli.core.suggest import listing
from mpmcli.cracks.crossing import OF, is_left
from mpmcli.scene.crack_checks import zones_of
from mpmcli.shapes import SHAPES
from mpmcli.solver.simulation import Simulation

Array = np.ndarray

MOST_CRACKS = 6
"""Cracks that are told one by one."""
WHOLE = 2.0**-24
"""Unit of positions of segments, in cells."""


def crack_facts(scene: Any, simulation: Simulation) -> dict[str, Any]:
    """Return what is known of the cracks of a scene, fit for JSON; ``{}`` without."""
    cracks, grid = simulation.cracks, simulation.grid
    if cracks is None:
        return {}
    sides = cracks.sides
    ordinary = grid.fields * grid.node_count
    extra = int(np.count_nonzero(grid.active >= ordinary))
    nodal = [array for array in simulation.nodal_arrays().values() if len(array) == grid.dof_count]
    per_dof = sum(array.nbytes for array in nodal) / grid.dof_count
    cut, nodes, tests = _cut_particles(scene, simulation)
    candidates = sides.candidates
    return {
        "cracks": [
            {
                "name": chain.name,
                "points": chain.count,
                "length": chain.length,
                "ends": ["tip" if is_tip else "mouth" for is_tip in chain.tips],
                "law": model.faces.law.kind,
                "separation": model.faces.separation,
                "pressure": None if model.pressure is None else model.pressure.source,
                "tractions": _tractions(chain),
                "gradual": model.growth is not None and model.growth.leaves_tractions,
                "moves": model.moves,
                "keep_apart": model.keep_apart,
                "respace": model.respace,
                "grows": model.growth is not None,
                "zone_cells": {
                    key: zone / max(scene.grid.cell)
                    for key, zone in zones_of(model, scene.bodies, scene.materials, scene.analysis.kind)
                    if math.isfinite(zone)
                },
            }
            for chain, model in zip(cracks.chains, scene.cracks, strict=True)
        ],
        "crack_nodes": nodes,
        "further_dofs": extra,
        "further_bytes": int(extra * per_dof),
        "candidates": len(candidates.particle),
        "cut_particles": cut,
        "candidate_bytes": sum(
            array.nbytes for table in (candidates, sides.sights, sides.crossings) for array in table
        ),
        "side_tests": tests,
        "tips": _domains(scene, simulation),
        "growth": _fastest_growth(simulation),
    }


def _tractions(chain: Any) -> int:
    """Return how many points of a crack carry tractions at the start."""
    law = chain.numbers.get("law")
    return 0 if law is None else int(np.count_nonzero(law))


def _cut_particles(scene: Any, simulation: Simulation) -> tuple[int, int, int]:
    """Return how many particles cracks cut at the start, of how many nodes, and how many lines of sight are tested.

    Each pair of a particle and a node of its stencil is a line of sight, and is tested against segments near it.
    """
    assert simulation.cracks is not None
    grid, sides = simulation.grid, simulation.cracks.sides
    particle = sides.candidates.particle.astype(np.int64)
    X = simulation.particles.X[:, particle]
    x = (X - (grid.lower - grid.pad * grid.cell)[:, None]) / grid.cell[:, None]
    w = grid.width
    first = np.floor(x).astype(np.int64) - (w - 2)
    along = np.arange(2 * w - 2)
    steps = np.stack(np.meshgrid(along, along, indexing="ij"), axis=-1).reshape(-1, 2)
    node = first[:, :, None] + steps.T[:, None, :]
    reach = _reach(scene, simulation, particle)[:, :, None] - 1e-9
    sees: Array = np.logical_and.reduce(np.abs(node - x[:, :, None]) < reach, axis=0)
    segments = sides.segments.whole
    ends, of = segments[:, :OF] * WHOLE, segments[:, OF]
    parted = np.zeros((int(of.max()) + 1, *sees.shape), dtype=bool)
    tests = 0
    for (ax, ay, bx, by), crack in zip(ends, of, strict=True):
        near = (x[0] > min(ax, bx) - w) & (x[0] < max(ax, bx) + w)
        near &= (x[1] > min(ay, by) - w) & (x[1] < max(ay, by) + w)
        rows = np.flatnonzero(near)
        tests += int(sees[rows].sum())
        px, py = x[0, rows, None], x[1, rows, None]
        nx, ny = node[0, rows], node[1, rows]
        apart = is_left(ax, ay, bx, by, px, py) != is_left(ax, ay, bx, by, nx, ny)
        apart &= is_left(px, py, nx, ny, ax, ay) != is_left(px, py, nx, ny, bx, by)
        parted[crack, rows] ^= apart
    beyond: Array = np.logical_or.reduce(parted, axis=0) & sees
    index = node[1] * grid.shape[0] + node[0]
    return int(beyond.any(axis=1).sum()), len(np.unique(index[beyond])), tests


def _reach(scene: Any, simulation: Simulation, particle: Array) -> Array:
    """How far particles see along each axis (2, n) [cells]."""
    shape = SHAPES[scene.method.shape]
    nodes = 1.5 if shape.grid_functions == "quadratic" else 1.0
    half = simulation.transfer.reach[:, particle] / simulation.grid.cell[:, None]
    return np.asarray(nodes + (half if shape.domain != "point" else 0.0 * half))


def _domains(scene: Any, simulation: Simulation) -> list[dict[str, Any]]:
    """Return the particles in the domain of each tip, and how many cells its ring is wide."""
    if scene.fracture is None or simulation.cracks is None:
        return []
    outer = scene.fracture.outer * float(simulation.grid.cell.min())
    found = []
    for chain in simulation.cracks.chains:
        for word, end, is_tip in zip(("start", "end"), (0, -1), chain.tips, strict=True):
            if is_tip:
                gap = simulation.particles.X - chain.X[:, end][:, None]
                distance = np.hypot(gap[0], gap[1])
                inside = int(np.count_nonzero(distance < outer))
                found.append({"tip": f"{chain.name}:{word}", "particles": inside})
    return found


def _fastest_growth(simulation: Simulation) -> list[dict[str, Any]]:
    """Return the largest speed that each growing tip can have, and what sets it, where something does."""
    growth = None if simulation.cracks is None else simulation.cracks.growth
    limits = [] if growth is None else [(tip.name, *growth.fastest(tip)) for tip in growth.growing]
    return [{"tip": tip, "speed": v, "because": words} for tip, v, words in limits if math.isfinite(v)]


# ---------------------------------------------------------------- in words


def cracks_in_words(facts: dict[str, Any]) -> list[str]:
    """Return the lines about cracks; none without them."""
    if not facts:
        return []
    lines = [_crack_in_words(crack) for crack in facts["cracks"][:MOST_CRACKS]]
    if len(facts["cracks"]) > MOST_CRACKS:
        rest = facts["cracks"][MOST_CRACKS:]
        lines.append(f"{len(rest)} more cracks of {sum(crack['points'] for crack in rest)} points in all")
    lines.append(
        f"sides: {facts['crack_nodes']} nodes have several sides at the start; {facts['further_dofs']} further degrees "
        f"of freedom ({_bytes(facts['further_bytes'])})"
    )
    lines.append(
        f"{facts['candidates']} particles near cracks (at most {_bytes(facts['candidate_bytes'])}), "
        f"{facts['cut_particles']} of them cut; at most {facts['side_tests']} tests of sides per step"
    )
    if facts["tips"]:
        tips = [f"{tip['tip']} {tip['particles']}" for tip in facts["tips"]]
        lines.append(f"particles in the domain of each tip: {listing(tips, MOST_CRACKS)}")
    return lines + [
        f"{tip['tip']} grows at most at {tip['speed']:.4g} ({tip['because']})"
        for tip in facts["growth"][:MOST_CRACKS]
    ]


def _crack_in_words(crack: dict[str, Any]) -> str:
    start, end = crack["ends"]
    words = [
        f"{crack['name']}: {crack['points']} points, length {crack['length']:.4g}",
        f"from a {start} to a {end}",
        f"faces {crack['law']}",
    ]
    if crack["separation"] != "displacement":
        words.append(f"their distance by {crack['separation']}")
    if crack["tractions"]:
        words.append(f"cohesive tractions on {crack['tractions']} points")
    if crack["pressure"] is not None:
        words.append(f"pressure {crack['pressure']}")
    if crack["grows"]:
        words.append("grows and leaves tractions" if crack["gradual"] else "grows")
    if crack["moves"] != "average":
        words.append(
            {"mass": "plane moves with the mass of both sides", "fixed": "plane is fixed"}[crack["moves"]]
        )
    if crack["keep_apart"]:
        words.append("faces that pass the plane are put back")
    if crack["respace"]:
        words.append("points are respaced")
    if crack["zone_cells"]:
        words.append(f"smallest process zone {min(crack['zone_cells'].values()):.3g} cells")
    return ", ".join(words)


def _bytes(count: int) -> str:
    return f"{count / 2**20:.2g} MiB" if count >= 2**20 else f"{count / 1024:.3g} KiB"
