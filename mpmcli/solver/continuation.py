"""What the next step depends on, as arrays by name, and a simulation set back to it.

Everything else is made anew from the scene or from these arrays at the start of the next step, with the same bits. A
part of the simulation that remembers something from one step to the next has ``memory()``, which gives arrays and
numbers by name, and ``recall(memory)``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.materials.strain import block_count

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray

SUMS = ("work", "extra", "reactions")
"""Numbers and vectors by name that the state adds up or shows."""
BETWEEN = "|"
"""Between the parts of the name of a body's face."""


def state_arrays(s: Simulation) -> dict[str, Any]:
    """Arrays and numbers, by name, from which the simulation goes on to the same bits; not copied."""
    state, order, grid = s.state, s.order, s.grid
    found: dict[str, Any] = {
        "state.step": np.int64(state.step),
        "state.time": np.float64(state.time),
        "state.dt": np.float64(state.dt),
        "speed.wave": np.float64(s.wave_speed),
        "speed.particle": np.float64(s.particle_speed),
        "order.bands": order.bands,
        "order.chunks": order.chunks,
        "order.drift": np.float64(order.drift),
        "order.version": np.int64(order.version),
        "grid.active": grid.active,
        "grid.active_version": np.int64(grid.active_version),
        "grid.width": np.int64(grid.width),
    }
    for group in SUMS:
        members = getattr(state, group)
        found |= {f"{group}.{name}": np.asarray(value, dtype=np.float64) for name, value in members.items()}
    for key, identities in s.surface_identities.items():
        found[f"surface.{BETWEEN.join(map(str, key))}"] = identities
    for name, part in _parts(s).items():
        found |= {f"{name}.{key}": np.asarray(value) for key, value in part.memory().items()}
    return found | {f"particles.{name}": array for name, array in s.particles.arrays().items()}


def restore(s: Simulation, arrays: Mapping[str, Array]) -> None:
    """Set a simulation at the start of the same scene to a state that ``state_arrays`` gave.

    Raises
    ------
    ArchiveError
        If the arrays are not those of this simulation.
    """
    _check_fit(s, arrays)
    state, order, grid, p = s.state, s.order, s.grid, s.particles
    state.step, state.time = int(arrays["state.step"]), float(arrays["state.time"])
    state.dt = s._dt = float(arrays["state.dt"])
    s.wave_speed, s.particle_speed = float(arrays["speed.wave"]), float(arrays["speed.particle"])
    for group in SUMS:
        kept = {name: v if v.ndim else float(v) for name, v in _members(arrays, group).items()}
        getattr(state, group).clear()
        getattr(state, group).update(kept)
    s.surface_identities.clear()
    for name, identities in _members(arrays, "surface").items():
        body, axis, side = name.rsplit(BETWEEN, 2)
        s.surface_identities[body, int(axis), side] = identities
    for name in p.arrays():
        setattr(p, name, arrays[f"particles.{name}"])
    blocks = block_count(p.count)
    s._speed2, s._bad = s._speed2[:blocks], s._bad[:blocks]
    if s.arrays.X_new is not None:
        s.arrays.X_new = np.zeros_like(p.X)
    order.bands, order.chunks = arrays["order.bands"], arrays["order.chunks"]
    order.drift, order.version = float(arrays["order.drift"]), int(arrays["order.version"])
    grid.active, grid.active_version = arrays["grid.active"], int(arrays["grid.active_version"])
    grid.width = int(arrays["grid.width"])
    s.transfer.size_buffers()
    for name, part in _parts(s).items():
        part.recall(_members(arrays, name))
    s.keep_good_state()


def _parts(s: Simulation) -> dict[str, Any]:
    """The parts that remember something."""
    return {name: part for name, part in vars(s).items() if hasattr(part, "memory")}


def _members(arrays: Mapping[str, Array], group: str) -> dict[str, Array]:
    start = group + "."
    return {name.removeprefix(start): a for name, a in arrays.items() if name.startswith(start)}


def _check_fit(s: Simulation, arrays: Mapping[str, Array]) -> None:
    expected = {
        name: np.asarray(value)
        for name, value in state_arrays(s).items()
        if not name.startswith(("reactions.", "surface."))
    }
    missing = [name for name in expected if name not in arrays]
    if missing:
        raise ArchiveError(f"the checkpoint does not fit the simulation: it has no array '{missing[0]}'")
    count = arrays["particles.mass"].shape
    for name, array in expected.items():
        found = arrays[name]
        if found.dtype != array.dtype or found.ndim != array.ndim:
            raise ArchiveError(f"the checkpoint does not fit the simulation: '{name}' is of another kind")
        if name.startswith("particles.") and (*array.shape[:-1], *count) != found.shape:
            raise ArchiveError(
                f"the checkpoint does not fit the simulation: '{name}' has the shape {found.shape}"
            )
