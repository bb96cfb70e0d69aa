"""When Python looks for garbage. Imported by what must start at once: nothing of ours is imported here."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def keeping_all() -> Iterator[None]:
    """A context, or decorator, in which Python looks for no garbage.

    Importing modules, reading scenes and compiling make many objects that stay; looking through them again and again
    takes a fifth of the time.
    """
    was_looking = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_looking:
            gc.enable()
