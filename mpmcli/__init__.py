"""mpmcli: a material point method simulator driven by YAML scenes.

From Python::

    from mpmcli import load, run

    outcome = run(load("scene.yaml", sets=["time.end=2"]), "results/short")
    energy = outcome.results["kinetic_energy"]
"""

from typing import TYPE_CHECKING, Any

from mpmcli.core.version import VERSION

if TYPE_CHECKING:
    from mpmcli.results.reading import Results
    from mpmcli.run.api import load, resume, run

__version__ = VERSION
__all__ = ["Results", "load", "resume", "run"]

_HOMES = {"Results": "mpmcli.results.reading", "load": "mpmcli.run.api", "resume": "mpmcli.run.api"}


def __getattr__(name: str) -> Any:
    """The names of the library, imported when they are used: the command line's help needs none of them."""
    import importlib

    if name == "run":
        return importlib.import_module("mpmcli.run")
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'mpmcli' has no attribute '{name}'")
