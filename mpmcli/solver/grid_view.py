"""What a simulation shows of its grid: nodal fields, computed when somebody reads them."""

from collections.abc import Callable, Mapping

import numpy as np

from mpmcli.core.grid import Grid
from mpmcli.core.state import GridView

Array = np.ndarray


def view_of_grid(grid: Grid, v: Array, rigid_fields: tuple[bool, ...]) -> GridView:
    """Return mass, momentum, force and velocity at the user's nodes, of all velocity fields but rigid ones.

    ``v`` (dofs, d) are the grid velocities.
    """
    inside = grid.interior()
    d = grid.dimensions
    deformable = None if not any(rigid_fields) else ~np.array(rigid_fields)

    def summed(array: Array) -> Array:
        return grid.sum_of_fields(array, deformable)[inside]

    def velocity() -> Array:
        m = summed(grid.mp[:, 0])[:, None]
        momentum = summed(np.where(grid.mp[:, :1] > 0.0, grid.mp[:, :1] * v, 0.0))
        return np.divide(momentum, m, out=np.zeros_like(momentum), where=m > 0.0)

    view = GridView(
        lower=grid.lower,
        cell=grid.cell,
        nodes=tuple(int(n) for n in grid.cells + 1),
        fields={
            "mass": lambda: summed(grid.mp[:, 0]),
            "momentum": lambda: summed(grid.mp[:, 1 : 1 + d]),
            "force": lambda: summed(grid.f),
            "velocity": velocity,
        },
    )
    for side in range(grid.sides if grid.sides > 1 else 0):
        view.fields.update(_fields_of_side(grid, v, side, deformable))
    return view


def _fields_of_side(
    grid: Grid, v: Array, side: int, deformable: Array | None
) -> dict[str, Callable[[], Array]]:
    """Mass and velocity on one side of the user's nodes, of all velocity fields but rigid ones."""
    inside = grid.interior()

    def summed() -> Array:
        """Mass and momentum (n, 1 + d)."""
        dofs = grid.active[grid.side_of(grid.active) == side]
        if deformable is not None:
            dofs = dofs[deformable[grid.field_of(dofs)]]
        m = grid.mp[dofs, :1]
        total = np.zeros((grid.node_count, 1 + grid.dimensions))
        np.add.at(total, grid.node_of(dofs), np.hstack([m, np.where(m > 0.0, m * v[dofs], 0.0)]))
        return total[inside]

    def velocity() -> Array:
        total = summed()
        m = total[:, :1]
        return np.divide(total[:, 1:], m, out=np.zeros_like(total[:, 1:]), where=m > 0.0)

    return {f"mass_side_{side}": lambda: summed()[:, 0], f"velocity_side_{side}": velocity}


def show_on_grid(view: GridView, grid: Grid, fields: Mapping[str, Callable[[], Array]]) -> None:
    """Show further nodal fields, functions that give a row per node of the grid, at the user's nodes."""
    inside = grid.interior()

    def shown(field: Callable[[], Array]) -> Callable[[], Array]:
        return lambda: field()[inside]

    view.fields.update({name: shown(field) for name, field in fields.items()})
