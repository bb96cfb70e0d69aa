"""The nearest name, for messages such as "did you mean 'friction'?"."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import islice

MAX_WORD = 80
"""Longer words are like no name."""
MAX_NAMES = 500
"""So many names are compared with a word."""
MAX_SEARCHES = 20
"""So many suggestions are made for one scene: the search takes longer than all else that finds a problem."""

_searches_left: ContextVar[list[int] | None] = ContextVar("_searches_left", default=None)


@contextmanager
def few_suggestions() -> Iterator[None]:
    """Look for the nearest name for the first problems only, of all that are found inside."""
    if _searches_left.get() is not None:
        yield
        return
    token = _searches_left.set([MAX_SEARCHES])
    try:
        yield
    finally:
        _searches_left.reset(token)


def nearest(word: str, names: Iterable[str]) -> str | None:
    """The name most like ``word``, or None if none is alike."""
    left = _searches_left.get()
    if len(word) > MAX_WORD or (left is not None and left[0] <= 0):
        return None
    if left is not None:
        left[0] -= 1
    names = [name for name in islice(names, MAX_NAMES) if len(str(name)) <= MAX_WORD]
    by_lower = {str(name).lower(): str(name) for name in names}
    found = difflib.get_close_matches(word.lower(), by_lower, n=1, cutoff=0.55)
    return by_lower[found[0]] if found else None


def did_you_mean(word: str, names: Iterable[str]) -> str:
    """``"; did you mean 'name'?"``, or nothing if no name is alike."""
    name = nearest(word, names)
    return f"; did you mean '{name}'?" if name is not None and name != word else ""


def listing(names: Iterable[str], limit: int = 12) -> str:
    """Names with commas between, the last ones replaced by an ellipsis if there are many."""
    every = [str(name) for name in names]
    return ", ".join(every[:limit]) + (", …" if len(every) > limit else "")
