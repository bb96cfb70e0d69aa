"""The process that compiles for another one: ``python -m mpmcli.run.compiler``.

Reads pickled addresses of functions and types of arguments from stdin, and prints a line for each when its code is in
the cache. It ends when its stdin is closed: then whoever asked is gone.
"""

import gc
import importlib
import os
import pickle
import sys

from mpmcli.core.compiled.compiler import get_compiler_ready
from mpmcli.core.compiled.kernel import Call, find_compiled


def main() -> None:
    """Compile what is asked for until nobody asks any more."""
    gc.disable()  # what is compiled stays: looking for garbage takes a tenth of the time
    # what a library prints must not be taken for an answer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    importlib.import_module("mpmcli.solver.simulation")  # the kernels, and all that they are compiled with
    get_compiler_ready()
    while True:
        try:
            address, types = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        except Exception:  # classes that only the other process has
            answers.write(b"unknown\n")
        else:
            try:
                Call(find_compiled(*address), types).compile()
                answers.write(b"done\n")
            except Exception:
                answers.write(b"failed\n")
        answers.flush()


if __name__ == "__main__":
    main()
