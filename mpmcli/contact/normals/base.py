"""What a normal method is: a pydantic model (the scene's words), a named tuple of numbers, and one function.

A new method is one new file here (and its row in ``KINDS``): a
model registered in ``NORMALS``, its parameter tuple, and an
implementation of ``find_normal`` registered for the tuple's class.
"""

from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.model import Model, Quantity
from mpmcli.core.registry import Registry

KINDS = {
    "average_gradient": "average_gradient",
    "irls": "irls",
    "linear_regression": "linear_regression",
    "logistic_regression": "logistic_regression",
    "maximum_gradient": "maximum_gradient",
    "maximum_volume": "maximum_volume",
    "own_gradient": "own_gradient",
    "specified": "specified",
    "volume_weighted_gradient": "volume_weighted_gradient",
}
"""The module in this package of each kind."""

NORMALS = Registry("normal method", "mpmcli.contact.normals", KINDS)

FOUND, NOT_CONVERGED, DEGENERATE = 0, 1, 2
"""What ``find_normal`` returns: all is well; the last iterate was taken; the method gave no direction."""


class NormalModel(Model):
    """Base of all methods that find the normal of a contact."""

    shares_normal: ClassVar[bool] = True
    """Both sides use the normal ±n; otherwise each field finds its own, and momentum is not conserved."""
    least_rigid_bias: ClassVar[float] = 1.0
    """Below it a bias towards rigid bodies changes nothing."""
    is_given: ClassVar[bool] = False
    """The direction is the scene's word, which may be the wrong way round: a run looks when fields first meet."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> NamedTuple:
        """The numbers that the compiled functions need; ``cell`` is the cell's size per axis [length]."""
        raise TypeError(f"{type(self).__name__} gives no parameters")

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes, as (key, words)."""
        return []


class BiasedNormalModel(NormalModel):
    """Base of the methods that may trust a rigid body's surface more than what they find."""

    rigid_bias: Annotated[float, Quantity("1", ge=1)] = 1.0
    """Against a rigid body, its volume gradient is the normal unless the gradient that this method
    calculates is more than this factor larger; 1 is no bias. The regressions calculate no gradient: they
    take the rigid body's from a factor of 10 on [nairn2023notes, 3.5]."""
    rigid_normal: Literal["method", "surface"] = "method"
    """Normal against a rigid body: what this method finds (method), or that of the surface of the region that the
    body fills, which turns with it (surface)."""


@generic
def find_normal(
    normal: Any, axes: Any, neighbours: Any, count: Any, rigid: Any, order: Any, guess: Any, out: Any
) -> Any:
    """Find the unit normal of a contact, pointing from the field α to all others together, β.

    Parameters
    ----------
    normal
        Parameters of the method; their class chooses the implementation.
    axes
        A tuple of d numbers; only its length counts.
    neighbours, count
        ``contact.neighbours.Neighbours`` and the number of its valid columns.
    rigid
        0: no rigid body, −1: α is rigid, +1: β is rigid.
    order
        +1 or −1: sign of a specified normal, α before β or α deforming against a rigid β being +1. It
        changes sign when α and β are swapped.
    guess
        (d,) normal of the last step at this node, or zeros; read only by methods that reuse it.
    out
        (d,) receives a finite unit vector, whatever the neighbours.

    Returns
    -------
    ``FOUND``, ``NOT_CONVERGED`` (the last iterate was taken) or ``DEGENERATE``: the method gave no
    direction and ``gradients.fall_back`` found one.
    """
