"""Machine code only for what Python calls.

Numba optimises every function by itself and translates it into machine code, although callers get a copy of what was
optimised, which is optimised and translated again with them; the body of a parallel loop goes through this three times.
Here both happen when the address of a function is asked for, which takes a third off the time until a cold start runs.
"""

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.registry import cpu_target

BODY_OF_LOOP = "__numba_parfor_gufunc"
"""Begins the names of functions that hold the body of a parallel loop, which only kernels call."""

_environments: dict[str, Any] = {}
"""Numba's environments of functions without machine code, by the names of the variables that point to them."""


class LinkedLibrary(JITCodeLibrary):
    """Functions that become machine code when the address of one of them is asked for."""

    _is_native = False

    def _optimize_final_module(self) -> None:
        """Wait."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True
        if self._is_from_cache:
            self._make_native()

    @property
    def _is_from_cache(self) -> bool:
        return self._object_caching_enabled and self._compiled_object is not None

    def _make_native(self) -> None:
        self._is_native = True
        if not self._is_from_cache:
            super()._optimize_final_module()
        super()._finalize_final_module()
        codegen: Any = self._codegen
        for variable in self._final_module.global_variables:
            if variable.name in _environments:
                codegen.set_env(variable.name, _environments.pop(variable.name))

    def get_pointer_to_function(self, name: str) -> int:
        """Return the address of a function, 0 where the library has none of this name."""
        self._ensure_finalized()
        if not self._is_native and self._defines(name) and not self.name.startswith(BODY_OF_LOOP):
            self._make_native()
        address: int = super().get_pointer_to_function(name)
        return address

    def _defines(self, name: str) -> bool:
        functions = self._final_module.functions
        return any(each.name == name and not each.is_declaration for each in functions)

    def serialize_using_object_code(self) -> Any:
        """Return what the cache on disk keeps."""
        return super().serialize_using_object_code() if self._is_native else self.serialize_using_bitcode()


def _translate_on_demand() -> None:
    codegen = cpu_target.target_context.codegen()
    set_now = codegen.set_env

    def set_env(name: str, environment: Any) -> None:
        if codegen._engine.is_symbol_defined(name):
            set_now(name, environment)
        else:
            _environments[name] = environment

    codegen._library_class, codegen.set_env = LinkedLibrary, set_env


_translate_on_demand()
