"""What the next step depends on, as arrays by name, and a simulation set back to it.

Everything else is made anew from the scene or from these arrays at the start of the next step, with the same bits. What
remembers something from one step to the next has ``memory()``, which gives arrays and numbers by name, and
``recall(memory)``.
"""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np

from mpmcli.core.errors import ArchiveError

Array = np.ndarray


class Remembers(Protocol):
    """What goes into a checkpoint."""

    def memory(self) -> Mapping[str, Any]:
        """Return arrays and numbers by name."""

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take them back."""


class Speeds:
    """The largest speeds of waves and particles."""

    def __init__(self, simulation: Any, stress: Any):
        self._simulation, self._stress = simulation, stress

    def memory(self) -> dict[str, float]:
        """Return both."""
        return {"wave": self._stress.wave_speed, "particle": self._simulation.particle_speed}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take them back."""
        self._stress.wave_speed = float(memory["wave"])
        self._simulation.particle_speed = float(memory["particle"])


def state_arrays(parts: Mapping[str, Remembers]) -> dict[str, Any]:
    """Return arrays and numbers, by name, from which a simulation goes on to the same bits; not copied."""
    return {
        f"{name}.{key}": np.asarray(value)
        for name, part in parts.items()
        for key, value in part.memory().items()
    }


def restore(parts: Mapping[str, Remembers], arrays: Mapping[str, Array]) -> None:
    """Set the parts of a simulation at the start of the same scene to a state that ``state_arrays`` gave.

    Raises
    ------
    ArchiveError
        If the arrays are not those of this simulation.
    """
    _check_fit(parts, arrays)
    for name, part in parts.items():
        start = f"{name}."
        part.recall({key.removeprefix(start): a for key, a in arrays.items() if key.startswith(start)})


def _check_fit(parts: Mapping[str, Remembers], arrays: Mapping[str, Array]) -> None:
    optional = ("state.reactions.", "surface.")  # they come with the first step
    expected = {name: array for name, array in state_arrays(parts).items() if not name.startswith(optional)}
    missing = [name for name in expected if name not in arrays]
    if missing:
        raise ArchiveError(f"the checkpoint does not fit the simulation: it has no array '{missing[0]}'")
    count = arrays["particles.mass"].shape
    for name, array in expected.items():
        found = arrays[name]
        if found.dtype != array.dtype or found.ndim != array.ndim:
            raise ArchiveError(f"the checkpoint does not fit the simulation: '{name}' has another type")
        if name.startswith("particles.") and (*array.shape[:-1], *count) != found.shape:
            raise ArchiveError(
                f"the checkpoint does not fit the simulation: '{name}' has the shape {found.shape}"
            )
