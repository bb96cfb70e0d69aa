"""What the machine gives at this moment, to set the time of a step beside it."""

from __future__ import annotations

import time

from mpmcli.core.compiled import runtime

runtime.configure()  # what numba reads when it is imported

import numba  # noqa: E402
import numpy as np  # noqa: E402


@numba.njit(parallel=True, fastmath=True)
def triad(a, b, c):
    """a = b + 3c."""
    for i in numba.prange(a.shape[0]):
        a[i] = b[i] + 3.0 * c[i]


@numba.njit(parallel=True)
def compute(count, out):
    """Chains of ``count`` multiplications and additions, one per member of ``out``."""
    for block in numba.prange(out.shape[0]):
        x = 1.0 + block
        for _ in range(count):
            x = x * 0.999999 + 1e-7
        out[block] = x


class Calibration:
    """Samples of a triad from memory, and of arithmetic without memory."""

    def __init__(self) -> None:
        self._arrays = [np.ones(8_000_000) for _ in range(3)]
        self._out = np.zeros(64)
        self.bandwidth: dict[int, list[float]] = {}
        self.arithmetic: dict[int, list[float]] = {}
        triad(*self._arrays)
        compute(10, self._out)

    def measure(self, threads: int) -> None:
        """Take one sample of both: gigabytes per second, nanoseconds per operation."""
        numba.set_num_threads(threads)
        begin = time.perf_counter()
        for _ in range(3):
            triad(*self._arrays)
        gigabytes = 3 * 3 * self._arrays[0].nbytes * 1e-9
        self.bandwidth.setdefault(threads, []).append(gigabytes / (time.perf_counter() - begin))
        begin = time.perf_counter()
        compute(500_000, self._out)
        operations = 2 * 500_000 * len(self._out)
        self.arithmetic.setdefault(threads, []).append((time.perf_counter() - begin) / operations * 1e9)
