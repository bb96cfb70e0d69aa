"""Expressions of columns: what a run stops by, and what events wait for."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from keyword import iskeyword
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.expressions import CONSTANTS, FUNCTIONS, Expression
from mpmcli.core.state import State
from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.output.columns import Column, all_columns, evaluate, unknown_column
from mpmcli.output.probes import make_probe
from mpmcli.output.quantities import Context
from mpmcli.output.snapshot import Snapshot

CLOCK: dict[str, Callable[[State], float]] = {
    "time": lambda state: state.time,
    "t": lambda state: state.time,
    "step": lambda state: float(state.step),
    "dt": lambda state: state.dt,
}
"""Names beside columns."""
NOT_USED = ("energy_error",)
"""Columns that depend on how often tables are written."""
WITHOUT_ROWS = ("particle", "point", "pair")
"""Kinds of probe that show one row at a time."""
_WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?!\w*\s*\()")
_OWNED = re.compile(r"([A-Za-z_]\w*)\[([^\[\]]*)\]")


class Criteria:
    """Reads conditions of a scene, given what it has."""

    def __init__(self, scene: Any, context: Context):
        self._constants = dict(scene.constants)
        self._context = context
        self._columns = {c.name: c for c in all_columns(context) if c.name not in NOT_USED}
        probes = [model for model in scene.probes if model.kind in WITHOUT_ROWS]
        self._probes = {model.name: _columns_of_probe(model, context) for model in probes}

    def read(self, text: str) -> Condition:
        """Read a condition; ValueError with words for the user."""
        sources: dict[str, Column | tuple[str, int] | str] = {}

        def stand_in(source: Any) -> str:
            name = f"column_{len(sources)}_"
            sources[name] = source
            return name

        plain = text
        for probe in sorted(self._probes, key=len, reverse=True):
            owned = re.compile(rf"(?<![\w.]){re.escape(probe)}\.(\w+)")
            for column in dict.fromkeys(owned.findall(plain)):
                name = stand_in((probe, self._row(probe, column)))
                plain = re.sub(rf"(?<![\w.]){re.escape(probe)}\.{column}\b", name, plain)
        plain = _OWNED.sub(lambda found: stand_in(self._column(found[0])), plain)
        for word in dict.fromkeys(_WORD.findall(plain)):
            if iskeyword(word) or any(
                word in known for known in (sources, self._constants, CONSTANTS, FUNCTIONS)
            ):
                continue
            sources[word] = word if word in CLOCK else self._column(word)
        expression = Expression(plain, self._constants, tuple(sources))
        if not expression.variables:
            raise ValueError(f"'{text}' names no column, so that it never changes")
        return Condition(expression, {name: sources[name] for name in sorted(expression.variables)})

    def _column(self, name: str) -> Column:
        if name in self._columns:
            return self._columns[name]
        if name in NOT_USED:
            raise ValueError(f"'{name}' depends on how often tables are written, and is no criterion")
        raise ValueError(unknown_column(name, self._columns, self._context))

    def _row(self, probe: str, name: str) -> int:
        columns = self._probes[probe]
        if name not in columns:
            hint = did_you_mean(name, columns) or f" ({listing(columns)})"
            raise ValueError(f"the probe '{probe}' has no column '{name}'{hint}")
        return columns.index(name)


class Condition:
    """An expression of columns."""

    def __init__(self, expression: Any, sources: Mapping[str, Any]):
        self._expression, self._sources = expression, dict(sources)

    def is_true(self, snapshot: Snapshot, probes: Mapping[str, Any]) -> bool:
        """Whether it is true of a state; ``probes`` are those of the scene by name."""
        named = {name: source for name, source in self._sources.items() if isinstance(source, Column)}
        values = dict(zip(named, evaluate(named.values(), snapshot), strict=True))
        for name, source in self._sources.items():
            if isinstance(source, str):
                values[name] = CLOCK[source](snapshot.state)
            elif isinstance(source, tuple):
                values[name] = probes[source[0]].look(snapshot)[source[1]]
        value = self._expression(t=values.pop("t", 0.0), **values)
        return bool(np.isfinite(value) and value != 0.0)


def conditions_of(scene: Any) -> list[tuple[str, str]]:
    """Path and text of every condition of a scene."""
    found = [] if scene.time.stop_when is None else [("time.stop_when", scene.time.stop_when.condition)]
    return found + [(f"events.{i}.when", event.when.condition) for i, event in enumerate(scene.events or ())]


def check_conditions(scene: Any, context: Context) -> None:
    """Raise SceneError if a condition of the scene cannot be read."""
    texts = conditions_of(scene)
    if not texts:
        return
    criteria, problems = Criteria(scene, context), []
    for path, text in texts:
        try:
            criteria.read(text)
        except ValueError as error:
            problems.append(Problem(path, str(error), code="criterion"))
    if problems:
        raise SceneError(problems)


def probes_of(scene: Any, state: State, context: Context) -> dict[str, Any]:
    """Return the probes of a scene that conditions may read, by name; ``state`` is that of the start."""
    return {
        model.name: make_probe(model, state, context, f"probes.{i}")
        for i, model in enumerate(scene.probes)
        if model.kind in WITHOUT_ROWS
    }


def _columns_of_probe(model: Any, context: Context) -> Sequence[str]:
    """Names of the columns of a probe; none if they are wrong, which is reported elsewhere."""
    try:
        return make_probe(model, None, context, "").columns
    except SceneError:
        return ()
