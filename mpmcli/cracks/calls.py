"""How Python calls compiled code once for much work on few nodes and particles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmcli.core.compiled.kernel import Compiled


def called_once(function: Callable[..., Any]) -> Any:
    """Decorate a long function that Python calls, and that allocates nothing.

    As ``core.compiled.kernel.inline``, but views are not counted, as in kernels: counting them takes several times
    longer than the work.
    """
    return Compiled(function, _nrt=False)
