"""The transfer kernels as plain Python: the same sums as compiled, to round-off."""

import numpy as np
import pytest

from mpmcli.core.compiled.kernel import Compiled
from mpmcli.core.transfer import kernels as transfer


@pytest.fixture
def in_python(monkeypatch):
    """Function: call a kernel as Python; all functions that it calls run as Python, too."""

    def call(kernel, *arguments):
        with monkeypatch.context() as patch:
            patch.setattr(Compiled, "__call__", lambda self, *each: self.py_func(*each))
            kernel.versions[False].py_func(*arguments)

    return call


def same(found, expected):
    assert np.abs(expected).max() > 0.1
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15 * np.abs(expected).max())


CASES = pytest.mark.parametrize(
    ("analysis", "shape"),
    [
        ("plane_strain", "lcpdi"),
        ("3d", "ugimp"),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in (
                ("uniaxial_stress", "b2gimp"),
                ("uniaxial_strain", "b2cpdi"),
                ("plane_stress", "bspline2"),
                ("plane_strain", "qcpdi"),
                ("axisymmetric", "ugimp"),
                ("axisymmetric", "lcpdi"),
                ("3d", "lcpdi"),
                ("3d", "linear"),
            )
        ),
    ],
)


@CASES
def test_scatters_give_the_compiled_sums(analysis, shape, cloud, in_python):
    c = cloud(analysis, shape, count=12)
    p = c.particles
    scattered = []
    for call in (in_python, lambda kernel, *arguments: kernel[False](*arguments)):
        mp, f = c.nodal(1 + c.dimensions), c.nodal()
        task = transfer.StateAndForces(p.mass, p.V, p.vol0, p.tau, mp.reshape(-1), f.reshape(-1))
        call(transfer.scatter, task, (0.0,) * c.dimensions, None, *c.operator(c.order.bands))
        scattered.append((mp, f))
    (mp, f), (expected_mp, expected_f) = scattered
    same(mp, expected_mp)
    same(f, expected_f)


@CASES
def test_gathers_give_the_compiled_sums(analysis, shape, cloud, in_python):
    c = cloud(analysis, shape, count=12)
    v = np.random.default_rng(4).standard_normal((c.grid.node_count, c.dimensions)).reshape(-1)
    gathered = []
    for call in (in_python, lambda kernel, *arguments: kernel[False](*arguments)):
        L = np.zeros_like(c.particles.L)
        call(transfer.find_velocity_gradients, (0.0,) * c.dimensions, *c.operator(c.order.chunks), v, L)
        gathered.append(L)
    same(*gathered)
