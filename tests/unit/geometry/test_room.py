"""The room as a whole: what importing it costs, and the scale of its files."""

import subprocess
import sys


def test_importing_the_regions_loads_no_readers():
    code = (
        "import sys, mpmcli.geometry; "
        "print([m for m in ('vtkmodules', 'PIL', 'meshio', 'matplotlib', 'pint') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
