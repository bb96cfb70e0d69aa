"""Strain-update schemes and transfer methods as rows of data (Nairn 2026, Fig. 1 and Eqs. 7–9)."""

from dataclasses import dataclass


@dataclass(frozen=True)
class StrainUpdate:
    """When particle stress and strain are updated within a step.

    Attributes
    ----------
    first, last : fraction of the step taken before the forces (tasks 1.b–1.d) and after the motion (task 5)
    again : momenta are extrapolated again from the new particle velocities before the last one (tasks 4.a–4.c)
    """

    first: float
    last: float
    again: bool


STRAIN_UPDATES = {
    "usf": StrainUpdate(1.0, 0.0, False),
    "usl": StrainUpdate(0.0, 1.0, False),
    "usl+": StrainUpdate(0.0, 1.0, True),
    "usavg": StrainUpdate(0.5, 0.5, False),
    "usavg+": StrainUpdate(0.5, 0.5, True),
}


@dataclass(frozen=True)
class TransferMethod:
    """How grid velocities reach the particles.

    Attributes
    ----------
    full_mass : grid velocities are v⁺(k) of the FMPM loop, else lumped v⁺(1)
    flip : particles keep their velocity and add S a Δt, else they take on a grid velocity
    projects : that grid velocity is the filtered m(v − v*) + a Δt of XPIC(m)
    """

    full_mass: bool
    flip: bool
    projects: bool


TRANSFER_METHODS = {
    "flip": TransferMethod(full_mass=False, flip=True, projects=False),
    "xpic": TransferMethod(full_mass=False, flip=False, projects=True),
    "fmpm": TransferMethod(full_mass=True, flip=False, projects=False),
}


def increment_factor(blend: tuple[int, float] | None, order: int) -> float:
    """Return the factor of the increment of order ℓ of blended FMPM (Nairn 2026, section 3.3).

    Parameters
    ----------
    blend : order m and fraction α of the blend, or None
    order : ℓ from 2 on

    Returns
    -------
    float
        α if ℓ mod m = 1 or m = 1, else 1.
    """
    if blend is None:
        return 1.0
    m, fraction = blend
    return fraction if m == 1 or order % m == 1 else 1.0
