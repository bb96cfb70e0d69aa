"""Images of particles near contact nodes: across symmetry planes, and whole periods of the grid away."""

import math
from typing import NamedTuple

import numpy as np

from mpmcli.contact.near_particles import IMAGE_BITS, NEAREST
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.grid import Grid

Array = np.ndarray


class Images(NamedTuple):
    """Images of a particle: one row per combination of symmetry planes, and of whole periods of periodic axes.

    The number of an image, counted from 1, is ``copies`` times that of its planes, plus that of its shift.
    """

    line: Array
    """(images, d) index of the mirroring line of nodes along each axis, −1 where the image is not turned."""
    shift: Array
    """(images, d) nodes by which the image is moved along each axis."""
    flag: Array
    """(images,) bit a is set if axis a is turned; from bit 4 on the number of the image."""
    copies: int
    """Number of shifts, none included."""
    home: Array
    """(n,) number of the shift that takes a node into the first period; only with periodic axes."""


@inline
def flag_of_image(images, image, home):
    """Flag of an image of a particle near a node, whose shift ``home`` takes the particle's node into the first period.

    So positions are those in the first period: what is found at nodes that are one agrees to the last digit.
    """
    number = (image + 1) // images.copies * images.copies + home
    return (images.flag[image] & (NEAREST - 1)) | number << IMAGE_BITS


@inline
def image_of_node(geometry, line, shift, shape_of_grid, i):
    """Image of node ``i`` across the planes ``line`` (d,) or by ``shift`` (d,), −1 where it is not on the grid."""
    other = i
    for axis in range(len(geometry.stride)):
        if line[axis] >= 0 or shift[axis] != 0:
            stride = np.int64(geometry.stride[axis])
            index = i // stride % shape_of_grid[axis]
            there = 2 * line[axis] - index if line[axis] >= 0 else index + shift[axis]
            if there < 0 or there >= shape_of_grid[axis]:
                other = np.int64(-1)
            elif other >= 0:
                other += (there - index) * stride
    return other


def images_of(planes: list[tuple[int, int]], grid: Grid) -> Images:
    """The images that planes on different axes, and periods of the grid, make together."""
    shifts, home = _shifts_of(grid)
    lines, turned = [np.full(grid.dimensions, -1, dtype=np.int64)], [0]
    for chosen in range(1, 2 ** len(planes)):
        mine = [plane for j, plane in enumerate(planes) if chosen >> j & 1]
        if len({axis for axis, _ in mine}) < len(mine):
            continue
        lines.append(lines[0].copy())
        for axis, at in mine:
            lines[-1][axis] = at
        turned.append(sum(1 << axis for axis, _ in mine))
    flag = np.repeat(turned, len(shifts)) + (np.arange(len(lines) * len(shifts)) << IMAGE_BITS)
    return Images(
        np.repeat(np.stack(lines), len(shifts), axis=0)[1:],
        np.tile(shifts, (len(lines), 1))[1:],
        flag[1:].astype(np.int64),
        len(shifts),
        home,
    )


def most_alike(grid: Grid) -> int:
    """Return how many nodes are one with a node at most, itself included."""
    return math.prod(-(-grid.shape[a] // int(grid.cells[a])) for a in grid.periodic)


def _shifts_of(grid: Grid) -> tuple[Array, Array]:
    """Shifts (s, d) [nodes] between nodes that are one, the first none, and the one (n,) that takes each node home."""
    most = np.zeros(grid.dimensions, dtype=np.int64)
    for a in grid.periodic:
        most[a] = (grid.shape[a] - 1) // grid.cells[a]
    turns = np.stack(np.unravel_index(np.arange(np.prod(2 * most + 1)), tuple(2 * most + 1)), axis=1) - most
    order = np.argsort(turns.any(axis=1), kind="stable")
    if not grid.periodic:
        return turns * grid.cells, np.zeros(0, dtype=np.int64)
    nodes = np.arange(grid.node_count)
    home = grid.without_periods(nodes)
    index = [each // np.array(grid.stride)[:, None] % np.array(grid.shape)[:, None] for each in (nodes, home)]
    back = (index[1] - index[0]) // grid.cells[:, None]
    number = np.ravel_multi_index(tuple(back + most[:, None]), tuple(2 * most + 1))
    return turns[order] * grid.cells, np.argsort(order)[number].astype(np.int64)
