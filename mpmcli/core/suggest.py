"""The nearest name, for messages such as "did you mean 'friction'?"."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def nearest(word: str, names: Iterable[str]) -> str | None:
    """The name most like ``word``, or None if none is alike."""
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
