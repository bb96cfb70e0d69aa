"""The nearest name."""

from __future__ import annotations

import pytest

from mpmcli.core.suggest import did_you_mean, listing, nearest


@pytest.mark.parametrize(
    ("word", "expected"),
    [("frictoin", "friction"), ("FRICTION", "friction"), ("colomb", "coulomb"), ("zzz", None), ("", None)],
)
def test_nearest(word: str, expected: str | None) -> None:
    assert nearest(word, ["friction", "coulomb", "stick"]) == expected


def test_words() -> None:
    assert did_you_mean("colomb", ["coulomb"]) == "; did you mean 'coulomb'?"
    assert did_you_mean("nothing", ["coulomb"]) == ""
    assert listing(["a", "b"]) == "a, b"
    assert listing("abcdef", limit=2) == "a, b, …"
