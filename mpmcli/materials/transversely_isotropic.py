"""Transversely isotropic elasticity for large rotation: fibres, wood, layers."""

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import model_validator

from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.materials.anisotropic import Stiffness, stiffness_of
from mpmcli.materials.base import MATERIALS
from mpmcli.materials.orthotropic import ElasticWithAxes, PoissonRatio


@MATERIALS.register
class TransverselyIsotropic(ElasticWithAxes):
    """Transversely isotropic elastic: one axial direction, all directions across it alike.

    The law is that of `orthotropic`, for large rotation and small to moderate strain. `axes` of the body turn the axial
    direction.
    """

    kind: Literal["transversely_isotropic"]
    axis: Literal["x", "y", "z"] = "x"
    """Axial direction, before `axes` of the body turn it."""
    E_axial: PositivePressure
    """Young's modulus along the axial direction."""
    E_transverse: PositivePressure
    """Young's modulus across it."""
    G_axial: PositivePressure
    """Shear modulus of planes that contain the axial direction."""
    nu_axial: PoissonRatio
    """Poisson's ratio: transverse contraction over axial extension, of axial tension."""
    nu_transverse: Annotated[float, Quantity("1", gt=-1, lt=1)]
    """Poisson's ratio in the plane across it, whose shear modulus is E_transverse/(2(1 + nu_transverse))."""

    @model_validator(mode="after")
    def _is_stable(self) -> Self:
        limit = math.sqrt(0.5 * (1.0 - self.nu_transverse) * self.E_axial / self.E_transverse)
        if abs(self.nu_axial) >= limit:
            raise ValueError(
                f"a negative energy would be stored: nu_axial = {self.nu_axial:g} must lie between "
                f"±√((1 - nu_transverse)*E_axial/(2*E_transverse)) = ±{limit:.4g}"
            )
        return self

    @property
    def stiffness(self) -> Stiffness:
        """ℂ in material axes, of which the axial one is 1, 2 or 3 by ``axis`` [pressure]."""
        a = "xyz".index(self.axis)
        compliance = np.full((3, 3), -self.nu_transverse / self.E_transverse)
        compliance[a, :] = compliance[:, a] = -self.nu_axial / self.E_axial
        np.fill_diagonal(compliance, 1 / self.E_transverse)
        compliance[a, a] = 1 / self.E_axial
        across = self.E_transverse / (2 * (1 + self.nu_transverse))
        planes = ((0, 1), (1, 2), (0, 2))
        G12, G23, G13 = (self.G_axial if a in plane else across for plane in planes)
        return stiffness_of(compliance, (G12, G23, G13))
