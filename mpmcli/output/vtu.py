"""VTU files of particles and grid, and the PVD files that make a time series of them.

Raw appended data; every file holds its time as field data ``TimeValue``. Names, types and component order of
the arrays never change within a series. Particles are ordered by ``id``, one vertex cell each.
"""

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from mpmcli.core.state import GridView
from mpmcli.output.appended import DataSet, write_data_set
from mpmcli.output.files import SERIES, make_folder, write_text, writing
from mpmcli.output.probes import nodal_values
from mpmcli.output.quantities import Quantity
from mpmcli.output.snapshot import Snapshot

SYMMETRIC = ("XX", "YY", "ZZ", "XY", "YZ", "XZ")
NINE = ("XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ")
COMPONENT_NAMES = {"scalar": (), "vector": ("X", "Y", "Z"), "tensor": SYMMETRIC, "gradient": NINE}
GRADIENT_PLACES = {1: (0,), 3: (0, 4, 8), 4: (0, 1, 3, 4), 5: (0, 1, 3, 4, 8), 9: tuple(range(9))}
"""Where the stored rows of F and of the velocity gradient lie among the nine components."""
CELL_TYPES = {1: 3, 2: 9, 3: 12}
"""VTK's line, quadrilateral and hexahedron."""
CORNERS = {
    1: ("0", "1"),
    2: ("00", "01", "11", "10"),
    3: ("000", "001", "011", "010", "100", "101", "111", "110"),
}
"""Corners of a cell in VTK's order: whether each lies at the upper end of the axes z, y and x."""
VERTEX = 1
PRECISIONS = {"float32": np.float32, "float64": np.float64}


def spread(values: np.ndarray, rank: str) -> np.ndarray:
    """Stored rows in VTK's order: vectors 3, symmetric tensors 6 (XX YY ZZ XY YZ XZ), gradients 9 components.

    Parameters
    ----------
    values : (N,) or (rows, N)
    rank : a rank of ``Quantity``

    Returns
    -------
    (N,) for scalars, else (N, components); components that the analysis does not store are 0
    """
    if rank == "scalar":
        return values
    places = GRADIENT_PLACES[len(values)] if rank == "gradient" else tuple(range(len(values)))
    full = np.zeros((values.shape[1], len(COMPONENT_NAMES[rank])), dtype=values.dtype)
    full[:, places] = values.T
    return full


class VtuWriter:
    """Writes unstructured grids with one precision and compression.

    Parameters
    ----------
    precision : ``float32`` or ``float64`` of all floating-point arrays but the time
    compression : ``none``, ``lz4`` or ``zlib``
    """

    def __init__(self, precision: str = "float32", compression: str = "none"):
        self.type = PRECISIONS[precision]
        self.compression = compression

    def write(
        self,
        path: Path,
        time: float,
        points: np.ndarray,
        arrays: Sequence[tuple[str, np.ndarray, tuple[str, ...]]],
        cell_type: int = VERTEX,
        connectivity: np.ndarray | None = None,
    ) -> None:
        """Write one file.

        Parameters
        ----------
        points : (N, 3) positions [length]
        arrays : name, values (N,) or (N, components), and component names of each array on the points
        connectivity : (cells, points per cell) points of each cell; one vertex per point if absent
        """
        if connectivity is None:
            connectivity = np.arange(len(points), dtype=np.int64)[:, None]
        cells, corners = connectivity.shape
        members = {
            "connectivity": connectivity.ravel(),
            "offsets": np.arange(1, cells + 1, dtype=np.int64) * corners,
            "types": np.full(cells, cell_type, dtype=np.uint8),
        }
        ready = ((name, self._ready(values), names) for name, values, names in arrays)
        counts, kind = f'NumberOfCells="{cells}"', "UnstructuredGrid"
        data = DataSet(kind, counts, self._ready(points), ready, ("Cells", members))
        write_data_set(path, time, data, self.compression)

    def _ready(self, values: np.ndarray) -> np.ndarray:
        """Values as they stand in the file."""
        if values.dtype.kind != "f":
            return values
        with np.errstate(over="ignore"):
            # −0 becomes 0: ParaView 5.11 reads the range -0 to -0 as one up to 3.4e38
            return np.add(values, 0.0, dtype=self.type, casting="same_kind", order="C")


def particle_arrays(
    quantities: Sequence[Quantity], snapshot: Snapshot
) -> list[tuple[str, np.ndarray, tuple[str, ...]]]:
    """Name, values ordered by id, and component names of each quantity."""
    order = snapshot.order
    return [
        (q.name, spread(q.compute(snapshot)[..., order], q.rank), COMPONENT_NAMES[q.rank]) for q in quantities
    ]


def write_particles(
    writer: VtuWriter, path: Path, snapshot: Snapshot, quantities: Sequence[Quantity]
) -> None:
    """Write all particles of a state, with ``id``, ``body``, ``material`` and the quantities asked for."""
    points = spread(snapshot.particles.X[:, snapshot.order], "vector")
    writer.write(path, snapshot.state.time, points, particle_arrays(quantities, snapshot))


def write_grid(writer: VtuWriter, path: Path, snapshot: Snapshot, fields: Sequence[str]) -> None:
    """Write nodes and cells of the user's grid with nodal fields by name."""
    grid = snapshot.state.grid
    if grid is None:
        raise ValueError("the state has no grid")
    arrays = []
    for name in fields:
        values = nodal_values(snapshot, name)
        rank = "scalar" if values.ndim == 1 else "vector"
        arrays.append((name, values if rank == "scalar" else spread(values.T, rank), COMPONENT_NAMES[rank]))
    points, connectivity = mesh_of(grid)
    writer.write(path, snapshot.state.time, points, arrays, CELL_TYPES[len(grid.nodes)], connectivity)


def mesh_of(grid: GridView) -> tuple[np.ndarray, np.ndarray]:
    """Node positions (n, 3), x fastest, and the nodes of each cell (cells, 2ᵈ) in VTK's order."""
    d = len(grid.nodes)
    axes = [grid.lower[a] + grid.cell[a] * np.arange(grid.nodes[a]) for a in range(d)]
    places = np.meshgrid(*reversed(axes), indexing="ij")
    points = spread(np.stack([place.ravel() for place in reversed(places)]), "vector")
    index = np.arange(int(np.prod(grid.nodes))).reshape(tuple(reversed(grid.nodes)))
    ends = {"0": slice(None, -1), "1": slice(1, None)}
    cells = [index[tuple(ends[side] for side in corner)].ravel() for corner in CORNERS[d]]
    return points, np.stack(cells, axis=1)


class Series:
    """A time series: ``NAME/NAME_000012.vtu``, and ``NAME.pvd`` that lists them, rewritten with each file.

    Parameters
    ----------
    times : times of the files of an earlier run to go on from; those that follow are removed
    members : names of the files of one time, if they are several or have another name than the folder
    ending : that of the files
    """

    def __init__(
        self,
        directory: Path,
        name: str,
        times: Sequence[float] | None = None,
        members: Sequence[str] = (),
        ending: str = "vtu",
    ):
        self.directory, self.name = directory, name
        self.members, self.ending = tuple(members) or (name,), ending
        self.times: list[float] = []
        make_folder(directory / name)
        if times is not None:
            self.times = [float(time) for time in times]
            self._remove_others()
            self._list()

    def _remove_others(self) -> None:
        kept = {path for count in range(len(self.times)) for path in self._paths(count)}
        with writing(self.directory / self.name):
            for path in (self.directory / self.name).iterdir():
                if SERIES[self.name].fullmatch(path.name) and path not in kept:
                    path.unlink()

    def _paths(self, count: int) -> list[Path]:
        folder = self.directory / self.name
        return [folder / f"{member}_{count:06d}.{self.ending}" for member in self.members]

    def next_paths(self) -> list[Path]:
        """Paths of the next files, in the order of the members."""
        return self._paths(len(self.times))

    def add(self, time: float) -> None:
        """List the next files, which have been written."""
        self.times.append(time)
        self._list()

    def _list(self) -> None:
        lines = [
            f'    <DataSet timestep="{time:.17g}" part="{part}" file="{escape(f"{self.name}/{path.name}")}"/>'
            for count, time in enumerate(self.times)
            for part, path in enumerate(self._paths(count))
        ]
        text = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">\n'
        text += "  <Collection>\n" + "\n".join(lines) + "\n  </Collection>\n</VTKFile>\n"
        write_text(self.directory / f"{self.name}.pvd", text)
