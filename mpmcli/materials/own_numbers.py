"""Materials whose numbers differ from particle to particle: rows of the history hold the numbers of the law.

The particles of such a material have, after the rows of its history, one row for each member of the parameter tuple of
its law. The tuple's twin, made by ``with_own_numbers``, says where these rows start; its functions collect the numbers
of a particle and call those of the law. Scenes without such materials never come here.
"""

from __future__ import annotations

import functools
import inspect
import sys
from collections import namedtuple
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeVar

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.materials.base import (
    absorb_heat,
    absorb_work,
    bulk_slope,
    bulk_speed_squared,
    dissipated_heat,
    isentropic_growth,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.lateral import lateral_stretch, thickness_stretch

Parameters = TypeVar("Parameters", bound=type)

OF_PARTICLES = (
    absorb_heat,
    absorb_work,
    bulk_slope,
    bulk_speed_squared,
    dissipated_heat,
    kirchhoff_stress,
    lateral_stretch,
    strain_energy,
    thickness_stretch,
    wave_speed_squared,
)
"""Functions of a law that take a particle."""
OF_LAW = (isentropic_growth, needs_increment)
"""Those that take none: no number of a law may matter to them."""

TWINS: dict[type, Any] = {}
"""The tuple of a material with own numbers for that of its law."""


def with_own_numbers(law: Parameters) -> Parameters:
    """Class decorator of a parameter tuple of plain numbers: particles may have numbers of their own.

    It comes after ``needs_increment`` of the law is registered. The twin is an attribute of the law's module, where the
    compiler's cache finds it.
    """
    twin = namedtuple(f"Own{law.__name__}", ("first",), module=law.__module__)  # type: ignore[misc]
    setattr(sys.modules[law.__module__], twin.__name__, twin)
    members = ", ".join(f"H[m.first + {i}, p]" for i in range(len(law._fields)))  # type: ignore[attr-defined]
    numbers = compiled_too(_written("numbers", "m, H, p", f"law({members})", {"law": law}))
    for function in OF_PARTICLES:
        names = list(inspect.signature(function).parameters)
        call = f"function({', '.join(['numbers(m, H, p)', *names[1:]])})"
        function.register(twin)(
            _written("by_particle", ", ".join(names), call, {"function": function, "numbers": numbers})
        )
    for function in OF_LAW:
        function.register(twin)(function.implementations[law])
    TWINS[law] = twin
    return law


def _written(name: str, parameters: str, value: str, scope: dict[str, Any]) -> Callable[..., Any]:
    """A function of one line; the compiler wants the very parameters of the generic one."""
    exec(_code(f"def {name}({parameters}):\n    return {value}"), scope)
    function: Callable[..., Any] = scope[name]
    return function


@functools.cache
def _code(source: str) -> Any:
    """Laws of as many members share it: compiling it takes most of the time."""
    return compile(source, "<own numbers>", "exec")


class OwnMaterial:
    """A material whose particles have numbers of their own; all else is that of its model.

    Parameters
    ----------
    model : of the scene
    models : of its particles, which differ in numbers only
    analysis : name of the kind of analysis
    """

    def __init__(self, model: Any, models: Sequence[Any], analysis: str):
        self._model, self._models, self._analysis = model, models, analysis

    def __getattr__(self, name: str) -> Any:
        return getattr(self._model, name)

    @functools.cached_property
    def history(self) -> tuple[str, ...]:
        """Names of the history variables, then of the law's numbers."""
        names = type(self._model.parameters(self._analysis, False))._fields
        return (*self._model.history, *(f"own_{name}" for name in names))

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Where the numbers of particles start."""
        found: NamedTuple = TWINS[type(self._model.parameters(analysis, False))](len(self._model.history))
        return found

    @functools.cached_property
    def _fastest(self) -> float:
        return max(float(model.initial_wave_speed(self._analysis)) for model in self._models)

    def initial_wave_speed(self, analysis: str) -> float:
        """That of the particle with the fastest waves [velocity]."""
        return self._fastest
