"""Anisotropy of Hill's yield function (1948), by its coefficients, by ratios of yield stresses, or by R-values."""

import math
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from mpmcli.core.model import Model, Quantity
from mpmcli.materials.anisotropic import Stiffness

PositiveNumber = Annotated[float, Quantity("1", gt=0)]
Number = Annotated[float, Quantity("1")]


class Hill(NamedTuple):
    """Coefficients of σ̄² = F(σ₂₂−σ₃₃)² + G(σ₃₃−σ₁₁)² + H(σ₁₁−σ₂₂)² + 2Lσ₂₃² + 2Mσ₁₃² + 2Nσ₁₂² [-]."""

    F: float
    G: float
    H: float
    L: float
    M: float
    N: float

    @property
    def normal(self) -> np.ndarray:
        """The matrix (3, 3) of the part of the normal stresses."""
        F, G, H = self.F, self.G, self.H
        return np.array([[G + H, -H, -G], [-H, F + H, -F], [-G, -F, F + G]])

    @property
    def misfit(self) -> str:
        """What keeps the yield surface from being convex and closed but for pressure; nothing if it is.

        Raises OverflowError if the coefficients are not ordinary numbers.
        """
        if not all(math.isfinite(value**2) for value in self):
            raise OverflowError
        if min(self.L, self.M, self.N) <= 0.0:
            return f"L = {self.L:.4g}, M = {self.M:.4g} and N = {self.N:.4g} must be positive"
        sums = (self.F + self.G, self.G + self.H, self.H + self.F)
        products = self.F * self.G + self.G * self.H + self.H * self.F
        if min(sums) <= 0.0 or products <= 1e-9 * max(sums) ** 2:
            return (
                f"F + G, G + H, H + F and FG + GH + HF must be positive, with F = {self.F:.4g}, G = {self.G:.4g} and "
                f"H = {self.H:.4g}"
            )
        return ""


class Anisotropy(Model):
    """Base of the ways to give Hill's coefficients."""

    @property
    def coefficients(self) -> Hill:
        """Hill's coefficients."""
        raise TypeError(f"{type(self).__name__} gives no coefficients")

    @model_validator(mode="after")
    def _is_convex(self) -> Self:
        try:
            words = self.coefficients.misfit
        except ArithmeticError as problem:
            raise ValueError(
                "the coefficients of the yield function that follow are too large or too small"
            ) from problem
        if words:
            raise ValueError(f"the yield surface is not convex: {words}")
        return self


class Coefficients(Anisotropy):
    """Hill's coefficients themselves; F = G = H = 0.5 and L = M = N = 1.5 are von Mises yielding."""

    kind: Literal["coefficients"]
    F: Number
    """Coefficient of (σ₂₂ − σ₃₃)²."""
    G: Number
    """Coefficient of (σ₃₃ − σ₁₁)²; with G + H = 1 the flow stress is that of tension along axis 1."""
    H: Number
    """Coefficient of (σ₁₁ − σ₂₂)²."""
    L: Number = 1.5
    """Coefficient of 2σ₂₃²."""
    M: Number = 1.5
    """Coefficient of 2σ₁₃²."""
    N: Number = 1.5
    """Coefficient of 2σ₁₂²."""

    @property
    def coefficients(self) -> Hill:
        """As given."""
        return Hill(self.F, self.G, self.H, self.L, self.M, self.N)


class Ratios(Anisotropy):
    """Yield stresses over those of the isotropic material with the same flow stress: Y in tension, Y/√3 in shear."""

    kind: Literal["ratios"]
    R11: PositiveNumber = 1.0
    """Yield stress in tension along axis 1, over the flow stress."""
    R22: PositiveNumber = 1.0
    """The same along axis 2."""
    R33: PositiveNumber = 1.0
    """The same along axis 3."""
    R12: PositiveNumber = 1.0
    """Yield stress in shear of axes 1 and 2, over the flow stress/√3."""
    R13: PositiveNumber = 1.0
    """The same of axes 1 and 3."""
    R23: PositiveNumber = 1.0
    """The same of axes 2 and 3."""

    @property
    def coefficients(self) -> Hill:
        """F = ½(1/R22² + 1/R33² − 1/R11²) …, N = 3/(2 R12²) …"""
        a, b, c = (1.0 / R**2 for R in (self.R11, self.R22, self.R33))
        shear = (1.5 / R**2 for R in (self.R23, self.R13, self.R12))
        return Hill(0.5 * (b + c - a), 0.5 * (c + a - b), 0.5 * (a + b - c), *shear)


class RValues(Anisotropy):
    """Lankford's R-values of a sheet in the plane of axes 1 and 2: plastic strain across the width over the thickness.

    The flow stress is that of tension along axis 1, the direction of rolling.
    """

    kind: Literal["r_values"]
    r0: PositiveNumber
    """R-value of tension along axis 1."""
    r45: PositiveNumber
    """R-value of tension at 45 degrees."""
    r90: PositiveNumber
    """R-value of tension along axis 2."""

    @property
    def coefficients(self) -> Hill:
        """From R = H/G along axis 1, H/F along axis 2, N/(F + G) − ½ at 45 degrees, and G + H = 1; L = M = 1.5."""
        whole = 1.0 + self.r0
        N = (self.r0 + self.r90) * (1.0 + 2.0 * self.r45) / (2.0 * self.r90 * whole)
        return Hill(self.r0 / (self.r90 * whole), 1.0 / whole, self.r0 / whole, 1.5, 1.5, N)


HillAnisotropy = Annotated[Coefficients | Ratios | RValues, Field(discriminator="kind")]


class Modes(NamedTuple):
    """What the return needs: modes v of the normal stresses with P v = λ ℂ⁻¹ v, v·ℂ⁻¹v = 1, and λ of the shears.

    The third mode of the normal stresses is the pressure, whose λ is 0; in plane stress there are two modes only.
    """

    first: float
    """λ of the first mode [pressure]."""
    second: float
    first_1: float
    """Component 11 of the first mode [√pressure]."""
    first_2: float
    first_3: float
    second_1: float
    second_2: float
    second_3: float
    least: float
    """Smallest λ of all, shears included [pressure]."""


def modes_of(hill: Hill, C: Stiffness) -> Modes:
    """Modes of Hill's coefficients for a stiffness; with C33 = 0 it is that of plane stress."""
    n = 2 if C.C33 == 0.0 else 3
    normal = np.array([[C.C11, C.C12, C.C13], [C.C12, C.C22, C.C23], [C.C13, C.C23, C.C33]])[:n, :n]
    root = np.linalg.cholesky(normal)
    values, vectors = np.linalg.eigh(root.T @ hill.normal[:n, :n] @ root)
    v = np.zeros((3, 2))
    v[:n] = (root @ vectors)[:, -2:]
    shears = (2.0 * C.G12 * hill.N, 2.0 * C.G23 * hill.L, 2.0 * C.G13 * hill.M)
    numbers = (*values[-2:], *v[:, 0], *v[:, 1], min(values[-2], *shears))
    return Modes(*(float(each) for each in numbers))
