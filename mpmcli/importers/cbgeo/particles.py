"""Particles of the source: where they are, their volumes, materials and sets, and the regions that they fill."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpmcli.importers.cbgeo.mesh import RegularGrid, cover, rounded
from mpmcli.importers.cbgeo.reading import MAX_ROWS, Array, Input
from mpmcli.importers.cbgeo.source import EntitySets, FileGenerator, GaussGenerator

MAX_BOXES = 6
"""Boxes of a region; particles that fill more of them are written to a file."""
NEAR = 1e-3
"""How far particles may lie from the middles of sub-cells, in cells."""


@dataclass
class Cloud:
    """All particles of the source, by their numbers.

    Attributes
    ----------
    x : (n, d)
        Positions in the grid's axes.
    volume : (n,)
        Volumes: cell over number of particles in it, unless a file gives them.
    material : (n,)
        Numbers of materials.
    generator : (n,)
        Which generator made the particle.
    sets : dict
        Numbers of particles of each set.
    """

    x: Array
    volume: Array
    material: Array
    generator: Array
    sets: dict[int, Array] = field(default_factory=dict)
    stress: Array | None = None

    def members(self, number: int) -> Array | None:
        """The particles of a set; −1 is all of them."""
        return np.arange(len(self.x)) if number == -1 else self.sets.get(number)


def read_cloud(given: Input, grid: RegularGrid, sets: EntitySets) -> Cloud:
    """Make or read the particles of all generators that can be translated."""
    places: list[Array] = []
    materials: list[int] = []
    own_sets: dict[int, list[int]] = {}
    generators: list[int] = []
    count = 0
    for index, entry in enumerate(given.source.particles):
        made = entry.generator
        at = ("particles", index, "generator")
        if isinstance(made, FileGenerator):
            x = _from_file(given, grid, made, index)
        elif isinstance(made, GaussGenerator):
            x = _gauss(given, grid, sets, made, index)
        else:
            x = np.zeros((0, grid.d))
        if count + len(x) > MAX_ROWS:
            raise given.fault(f"more than {MAX_ROWS:,} particles", *at)
        material = made.material_id if isinstance(made.material_id, int) else (made.material_id or (0,))[0]
        places.append(x)
        materials += [material] * len(x)
        generators += [index] * len(x)
        if made.pset_id is not None:
            own_sets.setdefault(made.pset_id, []).extend(range(count, count + len(x)))
        count += len(x)
    x = np.concatenate(places)
    cloud = Cloud(
        x, _volumes(x, grid), np.array(materials, dtype=int), np.array(generators, dtype=int),
        {number: np.array(ids, dtype=int) for number, ids in own_sets.items()},
    )  # fmt: skip
    _add_sets(given, cloud, sets)
    _set_materials(given, cloud)
    _read_volumes(given, cloud)
    _read_stresses(given, cloud, grid)
    return cloud


def _from_file(given: Input, grid: RegularGrid, made: FileGenerator, index: int) -> Array:
    at = ("particles", index, "generator", "location")
    table = given.table(made.location, (1, grid.d, 3), *at)
    count = table.rows[0][0]
    if len(table.rows[0]) != 1:
        raise table.fault(0, "the first row must give the number of particles")
    if count != len(table.rows) - 1:
        raise table.fault(
            0, f"the first row counts {count:g} particles, but {len(table.rows) - 1} rows follow"
        )
    for row, numbers in enumerate(table.rows[1:], 1):
        if len(numbers) not in (grid.d, 3):
            raise table.fault(row, f"{grid.d} coordinates are needed for a particle, not {len(numbers)}")
    places = [numbers[: grid.d] for numbers in table.rows[1:]]
    x = grid.inside(np.array(places, dtype=float).reshape(-1, grid.d))
    at_cell = (x - grid.lower) / grid.cell
    outside = ~((at_cell >= -1e-9) & (at_cell <= grid.counts + 1e-9)).all(axis=1)
    if outside.any():
        raise table.fault(1 + int(np.argmax(outside)), "this particle is outside the mesh")
    double = np.unique(x, axis=0, return_index=True)[1]
    if len(double) != len(x):
        row = int(np.setdiff1d(np.arange(len(x)), double)[0])
        raise table.fault(1 + row, "another particle lies at the same place")
    return x


def gauss_points(n: int) -> Array:
    """Places of n Gauss points in a cell from 0 to 1."""
    return 0.5 + 0.5 * np.polynomial.legendre.leggauss(n)[0]


def sub_cells(n: int) -> Array:
    """Middles of n sub-cells of a cell from 0 to 1."""
    return (np.arange(n) + 0.5) / n


def _gauss(given: Input, grid: RegularGrid, sets: EntitySets, made: GaussGenerator, index: int) -> Array:
    cells = grid.cells
    if made.cset_id != -1:
        chosen = next((group for group in sets.cell_sets if group.id == made.cset_id), None)
        at = ("particles", index, "generator", "cset_id")
        if chosen is None:
            raise given.fault(f"there is no cell set {made.cset_id}", *at)
        if not chosen.set or max(chosen.set) >= len(cells):
            words = f"the cells of the set {made.cset_id} must be numbers from 0 to {len(cells) - 1}"
            raise given.fault(words, *at)
        cells = cells[np.unique(np.array(chosen.set))]
    if len(cells) * made.nparticles_per_dir**grid.d > MAX_ROWS:
        raise given.fault(f"more than {MAX_ROWS:,} particles", "particles", index, "generator")
    points = gauss_points(made.nparticles_per_dir)
    offsets = np.stack(np.meshgrid(*[points] * grid.d, indexing="ij"), axis=-1).reshape(-1, grid.d)
    return np.asarray((grid.lower + grid.cell * (cells[:, None, :] + offsets)).reshape(-1, grid.d))


def _cells_of(x: Array, grid: RegularGrid) -> Array:
    at = np.floor((x - grid.lower) / grid.cell + 1e-9).astype(int)
    return np.clip(at, 0, grid.counts - 1)


def _volumes(x: Array, grid: RegularGrid) -> Array:
    """The volume of the cell shared by the particles in it (n,)."""
    if not len(x):
        return np.zeros(0)
    key = np.ravel_multi_index(tuple(_cells_of(x, grid).T), tuple(grid.counts))
    _, cell, count = np.unique(key, return_inverse=True, return_counts=True)
    return np.asarray(grid.cell.prod() / count[cell])


def _add_sets(given: Input, cloud: Cloud, sets: EntitySets) -> None:
    for group in sets.particle_sets:
        ids = np.unique(np.array(group.set, dtype=int))
        if ids.size and ids[-1] >= len(cloud.x):
            words = (
                f"particle {ids[-1]} of the particle set {group.id} does not exist ({len(cloud.x)} particles)"
            )
            raise given.fault(words, "mesh", "entity_sets")
        cloud.sets[group.id] = ids


def _set_materials(given: Input, cloud: Cloud) -> None:
    if not given.source.mesh.update_materials:
        return
    for index, chosen in enumerate(given.source.material_sets):
        members = cloud.members(chosen.pset_id)
        if members is None:
            words = f"there is no particle set {chosen.pset_id}"
            raise given.fault(words, "material_sets", index, "pset_id")
        cloud.material[members] = chosen.material_id


def _read_volumes(given: Input, cloud: Cloud) -> None:
    name = given.source.mesh.particles_volumes
    if name is None:
        return
    table = given.table(name, (2,), "mesh", "particles_volumes")
    for row, (number, volume) in enumerate(zip(table.whole(0), table.array(slice(1, 2))[:, 0], strict=True)):
        if number >= len(cloud.x):
            raise table.fault(row, f"there is no particle {number} ({len(cloud.x)} particles)")
        if not volume > 0:
            raise table.fault(row, f"the volume {volume:g} is not above 0")
        cloud.volume[number] = volume


def _read_stresses(given: Input, cloud: Cloud, grid: RegularGrid) -> None:
    """Initial stresses (n, 6), xx yy zz xy yz xz in the grid's axes."""
    name = given.source.mesh.particles_stresses
    if name is None:
        return
    table = given.table(name, (1, 6), "mesh", "particles_stresses")
    if len(table.rows[0]) != 1 or len(table.rows) - 1 != len(cloud.x):
        words = f"a first row with the number of particles and {len(cloud.x)} rows of stresses are needed"
        raise table.fault(0, words)
    for row, numbers in enumerate(table.rows[1:], 1):
        if len(numbers) != 6:
            raise table.fault(row, f"6 components of stress are needed, not {len(numbers)}")
    stress = np.array(table.rows[1:], dtype=float)
    cloud.stress = _turned_stress(stress, grid.axes) if grid.is_turned else stress


def _turned_stress(stress: Array, axes: Array) -> Array:
    turn = np.eye(3)
    turn[: len(axes), : len(axes)] = axes
    full = stress[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    turned = turn.T @ full @ turn
    return np.asarray(turned.reshape(-1, 9)[:, [0, 4, 8, 1, 5, 2]])


@dataclass(frozen=True)
class Filled:
    """A region that particles fill evenly: boxes (lower, upper), particles per axis, and whether at Gauss points."""

    boxes: list[tuple[Array, Array]]
    per_axis: list[int]
    at_gauss_points: bool

    def region(self) -> dict[str, Any]:
        """The region of a scene."""
        made = [
            {"kind": "box", "lower": lower.tolist(), "upper": upper.tolist()} for lower, upper in self.boxes
        ]
        return made[0] if len(made) == 1 else {"kind": "union", "regions": made}


def filled(x: Array, volume: Array, grid: RegularGrid) -> Filled | None:
    """Recognise particles (n, d) that fill whole cells with the same sub-cells; None if they do not."""
    cells = _cells_of(x, grid)
    part = (x - grid.lower) / grid.cell - cells
    per_axis, pattern = [], []
    at_gauss = False
    candidates = [sub_cells(n) for n in range(1, 11)] + [gauss_points(n) for n in range(2, 11)]
    for along in part.T:
        which = next((i for i, points in enumerate(candidates) if _is_at(along, points)), None)
        if which is None or len(np.unique(np.round(along / NEAR))) < len(candidates[which]):
            return None
        at_gauss |= which >= 10
        per_axis.append(len(candidates[which]))
        pattern.append(np.argmin(np.abs(along[:, None] - candidates[which]), axis=1))
    wanted = int(np.prod(per_axis))
    if not np.allclose(volume, grid.cell.prod() / wanted, rtol=1e-4):
        return None
    sub = np.stack([cells[:, k] * per_axis[k] + pattern[k] for k in range(grid.d)], axis=1)
    different = np.unique(cells, axis=0)
    if len(np.unique(sub, axis=0)) != len(x) or len(different) * wanted != len(x):
        return None
    boxes = cover(different)
    if len(boxes) > MAX_BOXES:
        return None
    corners = [(grid.place(low), grid.place(high + 1)) for low, high in boxes]
    return Filled(corners, per_axis, at_gauss)


def _is_at(part: Array, points: Array) -> bool:
    return bool((np.abs(part[:, None] - points).min(axis=1) < NEAR).all())


def as_table(x: Array, volume: Array) -> str:
    """A table of particles for the region ``points``."""
    axes = "xyz"[: x.shape[1]]
    lines = [",".join([*axes, "volume"])]
    places = rounded(x)
    volumes = rounded(volume)
    lines += [
        ",".join(f"{value:.11g}" for value in (*row, size)) for row, size in zip(places, volumes, strict=True)
    ]
    return "\n".join(lines) + "\n"
