"""Probes: one table each, following a particle or standing at a point of the grid."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.state import GridView, State
from mpmcli.output.columns import resolve_fields, unknown_name
from mpmcli.output.quantities import AXES, Context, Quantity
from mpmcli.output.snapshot import Snapshot


class Probe(Protocol):
    """What the recorder asks of a probe."""

    name: str
    columns: list[str]
    dimensions: list[str]

    def look(self, snapshot: Snapshot) -> list[float]:
        """The numbers of its columns."""


class ParticleProbe:
    """Follows the particle of a body that was nearest to a point at the start.

    Parameters
    ----------
    near
        The point, shape (d,) [length].
    quantities
        What is written of it; NaN once the particle has been deleted.
    """

    def __init__(
        self,
        name: str,
        state: State,
        body: str | None,
        near: Sequence[float],
        quantities: Sequence[Quantity],
        context: Context,
    ):
        self.name = name
        self.quantities = list(quantities)
        self.id = nearest_particle(state, body, near)
        self.columns, self.dimensions = [], []
        for quantity in self.quantities:
            rows = quantity.rows(context)
            self.columns += [f"{quantity.name}_{row}" for row in rows] or [quantity.name]
            self.dimensions += [quantity.dimension] * max(1, len(rows))

    def look(self, snapshot: Snapshot) -> list[float]:
        """The numbers of its columns."""
        found = np.flatnonzero(snapshot.particles.id == self.id)
        if not len(found):
            return [float("nan")] * len(self.columns)
        values = [np.atleast_1d(q.compute(snapshot)[..., found[0]]) for q in self.quantities]
        return [number.item() for number in itertools.chain.from_iterable(values)]


class PointProbe:
    """Stands at a fixed point and reads nodal fields through linear functions.

    Only nodes with mass take part in a velocity (their weights are scaled to sum to 1); it is NaN where there
    is none. Before the first step everything is NaN.
    """

    def __init__(self, name: str, at: Sequence[float], fields: Sequence[str]):
        self.name = name
        self.at = np.array(at, dtype=float)
        self.fields = list(fields)
        self.columns, self.dimensions = [], []
        for field in self.fields:
            is_vector = field in GRID_VECTORS
            self.columns += [f"{field}_{axis}" for axis in AXES[: len(self.at)]] if is_vector else [field]
            self.dimensions += [GRID_DIMENSIONS[field]] * (len(self.at) if is_vector else 1)

    def look(self, snapshot: Snapshot) -> list[float]:
        """The numbers of its columns."""
        grid = snapshot.state.grid
        if grid is None or not snapshot.has_grid:
            return [float("nan")] * len(self.columns)
        nodes, weights = linear_weights(grid, self.at)
        held = grid.fields["mass"]()[nodes] > 0.0
        shares = np.where(held, weights, 0.0)
        total = shares.sum()
        numbers: list[float] = []
        for field in self.fields:
            values = nodal_values(snapshot, field)[nodes]
            if field == "velocity":
                values = shares @ values / total if total > 0.0 else np.full(len(self.at), np.nan)
            else:
                values = weights @ values
            numbers += [number.item() for number in np.atleast_1d(values)]
        return numbers


GRID_DIMENSIONS = {"mass": "mass", "velocity": "velocity", "momentum": "momentum", "force": "force"}
GRID_VECTORS = ("velocity", "momentum", "force")


def nodal_values(snapshot: Snapshot, name: str) -> np.ndarray:
    """A nodal field by name, (n,) or (n, d); mass, momentum and force are those of the full ring."""
    grid = snapshot.state.grid
    if grid is None:
        raise ValueError("the state has no grid")
    values = grid.fields[name]()
    return values if name == "velocity" else values * snapshot.full_ring


def linear_weights(grid: GridView, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The 2ᵈ nodes around a point, as flattened indices, and its multilinear weights there."""
    place = (np.asarray(at) - grid.lower) / grid.cell
    first = np.clip(np.floor(place).astype(int), 0, np.array(grid.nodes) - 2)
    part = place - first
    nodes, weights = [], []
    for corner in itertools.product((0, 1), repeat=len(part)):
        index, weight = 0, 1.0
        for axis in reversed(range(len(part))):
            index = index * grid.nodes[axis] + int(first[axis]) + corner[axis]
            weight *= part[axis] if corner[axis] else 1.0 - part[axis]
        nodes.append(index)
        weights.append(weight)
    return np.array(nodes), np.array(weights)


def nearest_particle(state: State, body: str | None, near: Sequence[float]) -> int:
    """Identity of the particle (of a body) nearest to a point; of equally near ones the smallest identity."""
    particles = state.particles
    owned = (
        np.ones(particles.count, dtype=bool) if body is None else particles.body == state.bodies.index(body)
    )
    if not owned.any():
        raise SceneError(f"a probe follows a particle of body '{body}', which has no particles")
    distance = ((particles.X[:, owned] - np.asarray(near, dtype=float)[:, None]) ** 2).sum(axis=0)
    # round-off must not decide between equally near particles
    candidates = distance <= distance.min() * (1.0 + 1e-9)
    return int(particles.id[owned][candidates].min())


def make_probe(model: Any, state: State, context: Context, path: str) -> Probe:
    """A probe from its words in the scene (``kind: particle`` or ``kind: point``).

    Raises
    ------
    SceneError
        If a column is unknown.
    """
    if model.name in (".", "..") or any(mark in model.name for mark in "/\\\0"):
        raise SceneError([Problem(f"{path}.name", f"'{model.name}' cannot be the name of a file")])
    if model.kind == "particle":
        quantities = resolve_fields(model.columns, context, f"{path}.columns")
        return ParticleProbe(model.name, state, model.body, model.near, quantities, context)
    for name in model.columns:
        if name not in GRID_DIMENSIONS:
            text = unknown_name(name, "field of the grid", GRID_DIMENSIONS)
            raise SceneError([Problem(f"{path}.columns", text, code="unknown_field")])
    return PointProbe(model.name, model.at, model.columns)
