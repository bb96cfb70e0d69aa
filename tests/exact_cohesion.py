"""Envelopes of cohesive laws by formulas of their own, and paths of straight openings through two modes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

PEAK = 0.2259


def unit_envelope(keys: dict[str, Any], x: np.ndarray) -> np.ndarray:
    """S/σ at x = δ/δ_c, of a shape in the scene's words."""
    peak, shape = keys.get("peak", PEAK), keys["shape"]
    if shape == "cubic":
        return np.where(x < 1.0, 6.75 * x * (1.0 - x) ** 2, 0.0)
    if shape == "trilinear":
        return np.interp(x, [0.0, peak, keys["kink_opening"], 1.0], [0.0, 1.0, keys["kink_strength"], 0.0])
    if shape == "triangular":
        return np.interp(x, [0.0, peak, 1.0], [0.0, 1.0, 0.0])
    xi, a = np.clip((x - peak) / (1.0 - peak), 0.0, 1.0), keys["alpha"]
    return np.where(x < peak, x / peak, (np.exp(-a * xi) - np.exp(-a)) / (1.0 - np.exp(-a)))


@dataclass
class Mode:
    """One mode of a joint: shape, strength and toughness; ``opening`` at failure by integration of the shape."""

    keys: dict[str, Any]
    strength: float
    toughness: float

    def __post_init__(self) -> None:
        area = quad(lambda x: float(unit_envelope(self.keys, np.array(x))), 0.0, 1.0, limit=200)[0]
        self.opening = self.toughness / (area * self.strength)

    def traction(self, opening: np.ndarray) -> np.ndarray:
        """Envelope S(δ)."""
        return self.strength * unit_envelope(self.keys, np.asarray(opening) / self.opening)

    def spent(self, opening: float) -> float:
        """What a monotone opening has dissipated per area: ∫S dδ − ½ S δ."""
        work = quad(lambda d: float(self.traction(np.array(d))), 0.0, opening, limit=200)[0]
        return work - 0.5 * float(self.traction(np.array(opening))) * opening


def work_of_mixed_failure(
    normal: Mode, tangential: Mode, angle: float, exponent: float
) -> tuple[float, float]:
    """Length of a straight opening at which (G_I/G_Ic)ⁿ + (G_II/G_IIc)ⁿ = 1, and the energy per area that it took.

    ``angle`` from the surface [rad]. What is still stored when it breaks is lost too.
    """
    s, c = np.sin(angle), np.cos(angle)

    def beyond(u: float) -> float:
        shares = normal.spent(u * s) / normal.toughness, tangential.spent(u * c) / tangential.toughness
        return float(sum(max(share, 0.0) ** exponent for share in shares)) - 1.0

    most = min(normal.opening / s, tangential.opening / c)
    u = brentq(beyond, 1e-6 * most, most) if beyond(most) > 0.0 else most
    work = sum(
        quad(lambda d, mode=mode: float(mode.traction(np.array(d))), 0.0, part, limit=200)[0]
        for mode, part in ((normal, u * s), (tangential, u * c))
    )
    return u, float(work)
