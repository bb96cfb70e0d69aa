"""What a region is: a set of points that a scene describes, turned and moved as it says.

A new region is one new file here, with a row in ``KINDS``: a model registered in ``REGIONS`` that says which points it
holds (``_inside``) and where it ends (``_bounds``); size (``_measure``) and centre (``_centroid``) where a closed form
is known. Own coordinates are those before ``rotate`` and ``translate``; the public methods speak of the
region as it stands.
"""

from collections.abc import Iterator
from typing import ClassVar, get_args

import numpy as np

from mpmcli.core.model import Model
from mpmcli.core.registry import Registry
from mpmcli.geometry.rotation import Rotation
from mpmcli.geometry.vectors import Vector

KINDS = {
    "bitmap": "bitmap",
    "box": "box",
    "cylinder": "cylinder",
    "difference": "combinations",
    "disk": "sphere",
    "ellipse": "ellipse",
    "ellipsoid": "ellipse",
    "half_space": "half_space",
    "intersection": "combinations",
    "mesh": "mesh",
    "points": "points",
    "polygon": "polygon",
    "sphere": "sphere",
    "union": "combinations",
}
"""The module in this package of each kind."""

REGIONS = Registry("region", "mpmcli.geometry", KINDS)

TOLERANCE = 1e-9
"""A point this near to the border, relative to the region's size, counts as inside."""

Array = np.ndarray


class Region(Model):
    """Base of all regions."""

    dimensions: ClassVar[frozenset[int]]
    """Numbers of grid axes for which the region is defined."""
    per_axis: ClassVar[tuple[str, ...]] = ()
    """Names of the fields that hold one number per axis."""
    gives_particles: ClassVar[bool] = False
    """True where the region is a list of particles, not a space to fill."""

    rotate: Rotation | None = None
    """Turn the region, before it is moved by `translate`."""
    translate: Vector | None = None
    """Move the region by this vector, after `rotate`."""

    # what a kind of region says of itself, in own coordinates

    def _inside(self, points: Array) -> Array:
        """Which of the points (d, n) belong to the region, (n,) booleans; the border belongs to it."""
        raise TypeError(f"{type(self).__name__} does not say which points it holds")

    def _bounds(self, d: int) -> tuple[Array, Array]:
        """Lower and upper corner of the smallest box around it, (d,) each; infinite where it has no end.

        A kind gives these, or ``_turned_bounds``.
        """
        if type(self)._turned_bounds is Region._turned_bounds:
            raise TypeError(f"{type(self).__name__} does not say where it ends")
        return self._turned_bounds(np.eye(d))

    def _measure(self, d: int) -> float | None:
        """Length, area or volume in closed form, or None."""
        return None

    def _centroid(self, d: int) -> Array | None:
        """Centre of length, area or volume (d,) in closed form, or None."""
        return None

    def _turned_bounds(self, turn: Array) -> tuple[Array, Array]:
        """Bounds of the points ``turn`` x; without better knowledge those of the turned box."""
        lower, upper = self._bounds(len(turn))
        with np.errstate(invalid="ignore"):
            ends = np.stack([turn * lower, turn * upper])
        ends[:, turn == 0] = 0.0
        return ends.min(axis=0).sum(axis=1), ends.max(axis=0).sum(axis=1)

    def _pivot(self, d: int) -> Array:
        """The point (d,) about which the region turns when the scene names none."""
        lower, upper = self._bounds(d)
        with np.errstate(invalid="ignore"):
            middle = 0.5 * (lower + upper)
        return np.where(np.isfinite(middle), middle, 0.0)

    # the region as it stands

    def contains(self, points: Array) -> Array:
        """Tell which points are inside.

        Parameters
        ----------
        points : (d, n) coordinates [length]

        Returns
        -------
        (n,) booleans. Points on the border (within 1e-9 of the region's size) are inside.
        """
        if self.translate is not None or self.rotate is not None:
            turn, shift = self._placement(len(points))
            points = points - shift[:, None]
            if self.rotate is not None:
                points = turned(turn.T, points)
        return self._inside(points)

    def bounds(self, d: int) -> tuple[Array, Array]:
        """Lower and upper corner, (d,) each [length], of a box around it; infinite where it has no end."""
        if self.rotate is None:
            lower, upper = self._bounds(d)
            shift = np.zeros(d) if self.translate is None else np.asarray(self.translate)
        else:
            turn, shift = self._placement(d)
            lower, upper = self._turned_bounds(turn)
        return lower + shift, upper + shift

    def own_bounds(self, d: int) -> tuple[Array, Array]:
        """Lower and upper corner, (d,) each [length], of the box around it before it is turned and moved."""
        return self._bounds(d)

    def holds(self, points: Array) -> Array:
        """Tell which points (d, n), in coordinates before it is turned and moved, are inside: (n,) booleans."""
        return self._inside(points)

    def turn(self, d: int) -> Array:
        """The orthogonal matrix (d, d) by which it is turned."""
        return self._placement(d)[0]

    def measure(self, d: int) -> float | None:
        """Length, area or volume of the region in closed form, or None where none is known."""
        return self._measure(d)

    def centroid(self, d: int) -> Array | None:
        """Centre of length, area or volume, (d,) [length], in closed form, or None where none is known."""
        own = self._centroid(d)
        if own is None:
            return None
        turn, shift = self._placement(d)
        return turn @ own + shift

    def place(self, points: Array) -> Array:
        """Carry points (d, n) from own coordinates to where the region stands."""
        turn, shift = self._placement(len(points))
        return turned(turn, points) + shift[:, None]

    def _placement(self, d: int) -> tuple[Array, Array]:
        """Matrix Q (d, d) and vector s (d,) with x = Q x_own + s."""
        shift = np.zeros(d) if self.translate is None else np.array(self.translate)
        if self.rotate is None:
            return np.eye(d), shift
        turn = self.rotate.matrix(d)
        about = self._pivot(d) if self.rotate.about is None else np.asarray(self.rotate.about)
        return turn, shift + about - turn @ about

    # what the scene's checks and reports ask for

    def own_dimensions(self) -> frozenset[int]:
        """Numbers of grid axes for which this region is defined, its ``kind`` considered."""
        return self.dimensions

    def misfits(self, d: int) -> Iterator[tuple[tuple[str | int, ...], str]]:
        """All that keeps the region from use on a grid with ``d`` axes: place in the region, and words."""
        kind = self.kind  # type: ignore[attr-defined]
        if d not in self.own_dimensions():
            fitting = " or ".join(f"{k}D" for k in sorted(self.own_dimensions()))
            kinds = get_args(type(self).model_fields["kind"].annotation)
            fits = [k for k in kinds if d in self.model_copy(update={"kind": k}).own_dimensions()]
            hint = f"; use kind '{fits[0]}'" if fits else ""
            yield (
                ("kind",),
                f"a region of kind '{kind}' needs a {fitting} analysis, and this one is {d}D{hint}",
            )
            return
        for name in (*self.per_axis, "translate"):
            value = getattr(self, name)
            if value is not None and len(value) != d:
                label = type(self).model_fields[name].alias or name
                yield (label,), f"a {d}D analysis needs one number per axis, not {len(value)}"
        if self.rotate is not None:
            for place, words in self.rotate.misfits(d):
                yield ("rotate", *place), words

    def step(self) -> float:
        """Size of the steps with which its border follows a smooth surface [length]; 0 where it has none."""
        return 0.0

    def files(self) -> list[str]:
        """Names of the files that the region reads, as the scene writes them."""
        return []

    def notes(self) -> list[str]:
        """What a set-up report should tell about the region, e.g. whether a mesh is closed."""
        return []


def turned(matrix: Array, points: Array) -> Array:
    """Matrix (d, d) times points (d, n), rounded alike for every point whatever its company."""
    return np.stack([sum(a * x for a, x in zip(row, points, strict=True)) for row in matrix])
