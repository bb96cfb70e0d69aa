"""Parameter tuples for particles that deform in space, and for those in the plane, whose code is shorter."""

import sys
from collections import namedtuple
from typing import Any

from mpmcli.core.compiled.dispatch import generic
from mpmcli.materials.base import needs_increment
from mpmcli.materials.defaults import no, with_defaults, yes
from mpmcli.materials.own_numbers import with_own_numbers
from mpmcli.materials.principal import (
    from_principal,
    principal_strains,
    strains_in_plane,
    strains_in_space,
    tensor_of_plane,
    tensor_of_space,
)


@generic
def is_planar(m: Any) -> Any:
    """Whether no tensor has shear across the plane."""


def in_space_and_plane(name: str, fields: tuple[str, ...], module: str) -> dict[bool, Any]:
    """Make a tuple class of these numbers for particles that deform in space (False), and one for the plane (True).

    Both need the increment of the deformation gradient, and become attributes of the module, where the compiler's cache
    finds them.
    """
    found = {}
    for planar in (False, True):
        made = namedtuple(f"Planar{name}" if planar else name, fields, module=module)  # type: ignore[misc]
        setattr(sys.modules[module], made.__name__, made)
        with_defaults(made)
        needs_increment.register(made)(yes)
        with_own_numbers(made)
        is_planar.register(made)(yes if planar else no)
        principal_strains.register(made)(strains_in_plane if planar else strains_in_space)
        from_principal.register(made)(tensor_of_plane if planar else tensor_of_space)
        found[planar] = made
    return found
