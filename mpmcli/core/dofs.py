"""Degrees of freedom: velocity field × node, on every side of a node.

dof = (side · fields + field) · node_count + node. Side 0 is the ordinary one. These functions are the only decoders;
they take numbers or arrays, and compiled code calls them, too.
"""

from typing import Any

from mpmcli.core.compiled.compiler import compiled_too


@compiled_too
def node_of(dof: Any, node_count: Any) -> Any:
    """Return the node of a degree of freedom."""
    return dof % node_count


@compiled_too
def field_of(dof: Any, node_count: Any, fields: Any) -> Any:
    """Return the velocity field of a degree of freedom, of ``fields`` in all."""
    return dof // node_count % fields


@compiled_too
def side_of(dof: Any, node_count: Any, fields: Any) -> Any:
    """Return the side of its node on which a degree of freedom is."""
    return dof // (node_count * fields)


@compiled_too
def dof_of(node: Any, field: Any, side: Any, node_count: Any, fields: Any) -> Any:
    """Return the degree of freedom of a node, a velocity field and a side."""
    return (side * fields + field) * node_count + node
