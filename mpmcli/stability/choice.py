"""The Courant number that ``courant: auto`` takes from step to step: the limit of what the bodies do just then.

in place
    No particle is farther than ``REACH`` from where it started, along axes along which its body has a free face, and
    all particles together fill a box: its faces stay near the places within their cells where they started. Not with
    contact: a block pressed on a rigid table was unstable at 0.51, where one on its own is not.
else
    The limit of the scene (``scene_limit``), as for bodies that pass all places slowly. So it is at all times where a
    body starts fast.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from mpmcli.stability.growth import NEAR, limit_at_rest
from mpmcli.stability.held import held_axes
from mpmcli.stability.linear_step import Scheme
from mpmcli.stability.scene_limit import (
    LARGEST_COURANT,
    SAFETY,
    Block,
    blocks_of,
    chosen_courant,
    is_fast_at_first,
    one_thread,
    scheme_of,
)

Array = np.ndarray

REACH = 0.2
"""Cells that particles of bodies "in place" may be away from where they started."""
EVERY = 20
"""Steps between looks at the particles."""
ROUND_OFF = 1e-6


class GivenCourant:
    """The Courant number that a scene gives, None for a fixed step."""

    def __init__(self, courant: float | None):
        self.courant = courant

    def at(self, step: int, particles: Any) -> float | None:
        """That of the step that begins."""
        return self.courant


class ChosenCourant(GivenCourant):
    """The Courant number of ``courant: auto``.

    Parameters
    ----------
    scene : the checked scene
    particles : as they start

    Attributes
    ----------
    otherwise, in_place : Courant numbers; the second None where that does not occur
    courant : the current one

    Raises
    ------
    SceneError
        If there is no known limit.
    """

    courant: float

    def __init__(self, scene: Any, particles: Any):
        self.otherwise = chosen_courant(scene) or LARGEST_COURANT
        super().__init__(self.otherwise)
        self.in_place: float | None = None
        places = None if is_fast_at_first(scene) else _places_of_box(scene, particles)
        if places is None:
            return
        blocks, scheme = list(blocks_of(scene)), scheme_of(scene)
        with one_thread():
            limits = [min(_at_rest(b, scheme, _near(places, b.axes))) * b.scale for b in blocks]
        courant = min(SAFETY * min(limits), LARGEST_COURANT)
        if courant <= self.otherwise:
            return
        self.in_place = courant
        free = np.array([~held_axes(scene, body) for body in scene.bodies]).T
        self._free = free / np.asarray(scene.grid.cell, dtype=float)[:, None]
        self._start = np.empty((len(particles.X), int(particles.id.max()) + 1))
        self._start[:, particles.id] = particles.X

    def at(self, step: int, particles: Any) -> float:
        """That of the step that begins, by what the particles do; they are looked at every ``EVERY`` steps."""
        if step % EVERY == 0 and self.in_place is not None:
            self.courant = self.in_place if self._farthest(particles) <= REACH else self.otherwise
        return self.courant

    def memory(self) -> dict[str, float]:
        """What it remembers from step to step."""
        return {"courant": self.courant}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self.courant = float(memory["courant"])

    def in_words(self) -> str:
        """When it takes which number, after a semicolon; empty if it is always the same."""
        if self.in_place is None:
            return ""
        place = f"{self.in_place:.3g} while no free face is more than {REACH:g} cells from its start"
        return f"; {place}, else {self.otherwise:.3g}"

    def _farthest(self, p: Any) -> float:
        """Cells that the particle is from its start that is farthest, along free axes."""
        away = np.abs(p.X - self._start[:, p.id])
        away *= self._free[:, p.body]
        return float(away.max())


def _at_rest(block: Block, scheme: Scheme, faces: Iterable[tuple[float, ...]]) -> list[float]:
    """Limits (over the block's scale) at rest with faces at these places."""
    return [limit_at_rest(block.lattice, scheme, places) for places in faces]


def _near(sides: Array, axes: tuple[tuple[int, ...], ...]) -> Iterator[tuple[float, ...]]:
    """Places of faces, along the axes of a block, where they start (``sides``, (2, d)) and ``REACH`` to both sides."""
    shifted = np.mod(sides[:, None] + np.array([-REACH, 0.0, REACH])[:, None], 1.0).reshape(
        -1, sides.shape[1]
    )
    places = np.maximum(np.minimum(shifted, 1.0 - shifted).round(9), NEAR)
    return iter({tuple(float(side[a]) for a in pair) for side in places for pair in axes})


def _places_of_box(scene: Any, p: Any) -> Array | None:
    """Places (2, d) within their cells of the lower and upper faces of the box that the particles fill, if they do."""
    if (p.velocity_field != p.velocity_field[0]).any():
        return None
    low, high = (p.X - p.size).min(axis=1), (p.X + p.size).max(axis=1)
    volume = np.prod(high - low)
    if abs(np.prod(2.0 * p.size, axis=0).sum() - volume) > ROUND_OFF * volume:
        return None
    found: Array = np.mod((np.array([low, high]) - scene.grid.lower) / scene.grid.cell, 1.0)
    return found
