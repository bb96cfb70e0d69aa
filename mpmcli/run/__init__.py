"""Wires a simulation to its outputs; may be called: ``from mpmcli import run; run("scene.yaml")`` is ``api.run``."""

import sys
import types
from typing import Any


class Room(types.ModuleType):
    """This package, which shares its name with the function that it is about."""

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Run a scene into a folder: see ``mpmcli.run.api.run``."""
        from mpmcli.run.api import run

        return run(*args, **options)


sys.modules[__name__].__class__ = Room
