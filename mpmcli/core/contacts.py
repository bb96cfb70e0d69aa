"""What contact tells others of the pairs of fields that meet at nodes."""

from typing import NamedTuple, Protocol

import numpy as np

Array = np.ndarray


class ContactRows(NamedTuple):
    """The contacts of a step, one row each.

    alpha, beta : (k,) degrees of freedom of the two sides
    touches : (k,) whether they touch
    area : (k,) area of contact [area]
    friction : (k,) energy that friction takes out in the step [energy]
    weight : (k,) share of the contact that real particles have: images beyond mirrors have none
    pair : (k,) number of the pair of fields
    sign : (k,) +1 where α belongs to the first field of the pair, else −1
    """

    alpha: Array
    beta: Array
    touches: Array
    area: Array
    friction: Array
    weight: Array
    pair: Array
    sign: Array


class TellsContacts(Protocol):
    """Contact, as others need it."""

    def contact_rows(self) -> ContactRows:
        """Return the contacts of this step, after the velocities are known and accounted for."""
