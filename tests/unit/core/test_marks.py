import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from mpmcli.core.marks import spread


@given(arrays(bool, array_shapes(max_dims=3, max_side=7)), st.integers(0, 4), st.integers(0, 4))
def test_every_place_near_a_mark_is_marked(mark, below, above):
    expected = np.zeros_like(mark)
    for at in np.argwhere(mark):
        expected[tuple(slice(max(i - below, 0), i + above + 1) for i in at)] = True
    assert np.array_equal(spread(mark, below, above), expected)
