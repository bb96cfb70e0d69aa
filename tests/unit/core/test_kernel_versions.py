"""The kernel decorator: serial and parallel versions with names of their own."""

import numpy as np

from mpmcli.core.compiled.kernel import BOUNDS_CHECK, Kernel, inline, kernel, prange


@inline
def doubled(x):
    return 2.0 * x


def double_all(values):
    """Double every value."""
    for i in prange(values.shape[0]):
        values[i] = doubled(values[i])


def test_both_versions_do_the_same_under_different_names():
    made = kernel(double_all)
    try:
        values = np.arange(5.0)
        made[False](values)
        assert made.compiled_signatures() == 1
        made[True](values)
        np.testing.assert_array_equal(values, 4 * np.arange(5.0))
        assert made.compiled_signatures() == 2
        assert made[False].__name__ == "double_all_serial"
        assert made[True].__name__ == "double_all_parallel"
        assert made[True].__doc__ == "Double every value."
        assert made.name == "double_all"
    finally:
        Kernel.registered.remove(made)


def test_kernels_are_listed_and_no_two_share_a_cache_entry():
    from mpmcli.core import order
    from mpmcli.core.transfer import kernels as transfer
    from mpmcli.core.transfer import nodes, stencil
    from mpmcli.materials import strain

    assert {nodes, order, stencil, transfer, strain}
    places = [(k[p].__module__, k[p].__qualname__) for k in Kernel.registered for p in (False, True)]
    assert len(places) == len(set(places))


def test_options_hold_for_every_kernel():
    """Cached, without the interpreter's lock, with numpy's division; bounds checks only when asked for."""
    for made in Kernel.registered:
        for parallel in (False, True):
            options = made[parallel].targetoptions
            assert options["nogil"]
            assert options["error_model"] == "numpy"
            assert options["parallel"] is parallel
            assert options["boundscheck"] == BOUNDS_CHECK
            assert made[parallel].stats.cache_path
