"""What all parts of a translation share: the source, its grid, sets and particles, and the scene that is made."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpmcli.importers.base import Expression, NoteKind, Translation, free_name
from mpmcli.importers.cbgeo.mesh import RegularGrid
from mpmcli.importers.cbgeo.particles import Cloud
from mpmcli.importers.cbgeo.reading import Array, Input, Keys, dotted
from mpmcli.importers.cbgeo.source import EntitySets, LinearFunction, NodeConstraint, SinFunction
from mpmcli.importers.scene_text import number_text

MAX_INLINE = 8
"""Points of a function that are written into an expression; more of them go to a file."""


@dataclass
class Work:
    """A translation under way."""

    given: Input
    made: Translation
    grid: RegularGrid
    sets: EntitySets
    cloud: Cloud
    functions: set[int] = field(default_factory=set)
    """Functions of time that something depends on."""

    @property
    def scene(self) -> dict[str, Any]:
        """The scene."""
        return self.made.scene

    def note(self, kind: NoteKind, keys: Keys, words: str) -> None:
        """Add a note about a key of the source."""
        self.made.note(kind, self.given.line(*keys), dotted(keys), words)

    def lacks(self, keys: Keys, words: str) -> None:
        """A key of the source is not supported."""
        self.note("not_supported", keys, words)

    def fault(self, keys: Keys, words: str) -> None:
        """Add a fault of the source."""
        self.made.error(self.given.line(*keys), dotted(keys), words)

    def place(self, path: Keys, keys: Keys) -> None:
        """Remember that a key of the scene comes from a key of the source."""
        line = self.given.line(*keys)
        if line is not None:
            self.made.lines[path] = line

    def load(self, name: str, kind: str, **rest: Any) -> str:
        """Add a load; the name that it has in the end."""
        loads = self.scene.setdefault("loads", [])
        free = free_name(name, [load["name"] for load in loads], " ")
        loads.append({"name": free, "kind": kind, **rest})
        return free

    def constant(self, name: str, value: float) -> None:
        """Name a number."""
        self.scene.setdefault("constants", {})[name] = value

    def nodes_and_axis(self, given: NodeConstraint, keys: Keys, *needed: str) -> tuple[Array, int] | None:
        """Numbers of nodes and the axis of a constraint; faults, and None, if they or ``needed`` are missing."""
        nodes, axis = self._nodes(given.nset_id, keys), self.axis(given.dir, keys)
        missing = [name for name in needed if getattr(given, name) is None]
        for name in missing:
            self.fault(keys, f"'{name}' is missing")
        return None if nodes is None or axis is None or missing else (nodes, axis)

    def _nodes(self, set_id: int | None, keys: Keys) -> Array | None:
        """Numbers of the nodes of a set; −1 is all of them."""
        if set_id == -1:
            return np.arange(len(self.grid.nodes))
        chosen = next((group.set for group in self.sets.node_sets if group.id == set_id), ())
        if set_id is None:
            self.fault(keys, "'nset_id' is missing")
        elif not chosen:
            self.fault((*keys, "nset_id"), f"there is no node set {set_id}, or it is empty")
        elif max(chosen) >= len(self.grid.nodes):
            words = f"of the set {set_id} does not exist ({len(self.grid.nodes)} nodes)"
            self.fault((*keys, "nset_id"), f"node {max(chosen)} {words}")
        else:
            return np.unique(np.array(chosen))
        return None

    def axis(self, direction: int | None, keys: Keys) -> int | None:
        """The axis of a constraint or load; a fault if it is missing or does not exist."""
        if direction is None:
            self.fault(keys, "'dir' is missing")
        elif direction >= self.grid.d:
            self.fault((*keys, "dir"), f"there is no axis {direction} in {self.grid.d}D")
        else:
            return direction
        return None

    def times(self, value: float, function_id: int | None, keys: Keys) -> float | Expression | None:
        """A value times its function of time, as a number or an expression."""
        if function_id is None or value == 0.0:
            return value
        functions = self.given.source.math_functions
        at = next((i for i, function in enumerate(functions) if function.id == function_id), None)
        if at is None:
            self.fault((*keys, "math_function_id"), f"there is no math function {function_id}")
            return None
        function = functions[at]
        self.functions.add(function_id)
        if isinstance(function, SinFunction):
            return self._sine(value, function)
        if isinstance(function, LinearFunction):
            return self._linear(value, function, ("math_functions", at))
        words = f"functions of type '{function.type}'; Linear and Sin are"
        self.lacks(("math_functions", at, "type"), words)
        return None

    def _sine(self, value: float, function: SinFunction) -> Expression:
        shifted = "t" if function.x0 == 0 else f"(t - {number_text(function.x0)})"
        wave = f"{times_text(value)}sin({number_text(function.a)}*{shifted})"
        if function.xrange is not None:
            wave += f"*(t >= {number_text(function.xrange[0])})*(t <= {number_text(function.xrange[1])})"
        return Expression(wave)

    def _linear(self, value: float, function: LinearFunction, keys: Keys) -> float | Expression | None:
        x, f = function.xvalues, function.fxvalues
        if len(x) != len(f):
            self.fault(keys, f"'xvalues' has {len(x)} values and 'fxvalues' {len(f)}")
            return None
        back = next((i for i in range(1, len(x)) if x[i] <= x[i - 1]), None)
        if back is not None:
            words = f"the values must increase, but {x[back]:g} follows {x[back - 1]:g}"
            self.fault((*keys, "xvalues"), words)
            return None
        if all(member == f[0] for member in f):
            return value * f[0]
        if len(x) > MAX_INLINE:
            name = f"function_{function.id}.csv"
            rows = [f"{number_text(a)},{number_text(b)}" for a, b in zip(x, f, strict=True)]
            self.made.files[name] = "\n".join(["t,value", *rows]) + "\n"
            return Expression(f'{times_text(value)}interpolate(t, "{name}")')
        last = max(i for i in range(1, len(x)) if f[i] != f[i - 1])  # constant from there on
        if last == 1 and f[0] == 0.0:
            return Expression(f"{times_text(value * f[1])}ramp(t, {number_text(x[0])}, {number_text(x[1])})")
        pairs = ", ".join(f"{number_text(x[i])}, {number_text(f[i])}" for i in range(last + 1))
        return Expression(f"{times_text(value)}interpolate(t, {pairs})")


def times_text(value: float) -> str:
    """A factor in front of a function."""
    return {1.0: "", -1.0: "-"}.get(value, f"{number_text(value)}*")
