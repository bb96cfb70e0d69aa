"""Pieces of crack faces inside a domain, which integrals over the matter around them must count."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class Faces(NamedTuple):
    """Straight pieces of faces in the frame of a tip, k of them; sides are 0, to which the normal points, and 1.

    x : (2, k) where the piece counts, from the tip: where 1/√r has its mean [length]
    normal : (2, k) unit normals from side 1 to side 0
    area : (k,) length, or length times radius [length], [area]
    traction : (2, k) on the matter of side 0; that on side 1 is opposite [pressure]
    slope : (2, 2, k) u_j,1 by side
    stress : (2, 3, k) Cauchy stress 11, 22, 12 by side [pressure]
    energy : (2, k) energy per volume by side, kinetic energy included where inertia counts [pressure]
    angle : (2, k) of ``elastic.tip_field`` by side
    """

    x: Array
    normal: Array
    area: Array
    traction: Array
    slope: Array
    stress: Array
    energy: Array
    angle: Array
