"""Lanes: the arithmetic of single numbers, several at once."""

import numpy as np
import pytest
from numba import njit

from mpmcli.core.lanes import each, load, pack, store, zeros

FAST = {"error_model": "numpy", "fastmath": {"nnan", "ninf", "nsz"}}


@njit(**FAST)
def scale_and_add(values, start, factor, added, out):
    total = load(values, np.uint64(start), added) + factor * pack(added)
    total -= pack(added) + zeros(added)
    store(out, np.uint64(start), total)
    return each(total)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_lanes_round_like_single_numbers(count):
    """Load, scale, add, subtract and store: bit for bit numpy's, and nothing beside them is touched."""
    values = np.random.default_rng(count).normal(size=9)
    added = tuple(np.random.default_rng(7).normal(size=count))
    out = np.full(9, np.nan)
    got = scale_and_add(values, 2, 0.3, added, out)
    wanted = (values[2 : 2 + count] + 0.3 * np.array(added)) - np.array(added)
    assert list(got) == list(wanted)
    np.testing.assert_array_equal(out[2 : 2 + count], wanted)
    assert np.isnan(np.delete(out, np.arange(2, 2 + count))).all()
