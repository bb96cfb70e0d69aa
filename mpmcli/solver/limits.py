"""Largest stable Courant numbers that are known, to warn with and to show margins."""

from __future__ import annotations

import numpy as np

# measured with inputs/vibrating_bar.yaml: kinetic and strain energy below 1.05 of the start for five periods
_ORDERS = np.array([1.0, 2.0, 4.0, 8.0, 40.0])
_FMPM_LCPDI = np.array([0.86, 0.67, 0.53, 0.40, 0.24])
_FLIP_LCPDI = 0.83


def known_limit(shape: str, transfer: str, order: int) -> float | None:
    """Largest Courant number at which the 1D bar was seen to be stable, or None where nobody has measured it.

    Between the measured orders of FMPM(k) the limit is interpolated in ln k; above the last it stays (it levels off,
    Nairn 2026, Fig. 12A).
    """
    if shape != "lcpdi":
        return None
    if transfer == "flip":
        return _FLIP_LCPDI
    if transfer == "fmpm":
        return float(np.interp(np.log(order), np.log(_ORDERS), _FMPM_LCPDI))
    return None
