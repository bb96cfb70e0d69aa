"""What is imported with the compiler."""

import subprocess
import sys

import pytest

SCRIPT = """
import sys
import numpy as np
from mpmcli.core.compiled.compiler import get_compiler_ready
get_compiler_ready()
from numba.core.registry import cpu_target
cpu_target.target_context.refresh()
print("scipy.linalg" in sys.modules)
import numba, scipy.linalg
print(float(numba.njit(lambda a: np.dot(a, a)[0, 0])(2.0 * scipy.linalg.inv(np.eye(2)))))
"""


@pytest.mark.slow
def test_scipy_is_left_alone_and_works_later():
    pytest.importorskip("scipy")
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], capture_output=True, text=True, timeout=300, check=True
    )
    assert done.stdout.split() == ["False", "4.0"]
