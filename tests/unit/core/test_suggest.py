"""The nearest name."""

import pytest

from mpmcli.core.suggest import OTHER_WORDS, did_you_mean, listing, nearest


@pytest.mark.parametrize(
    ("word", "expected"),
    [("frictoin", "friction"), ("FRICTION", "friction"), ("colomb", "coulomb"), ("zzz", None), ("", None)],
)
def test_nearest(word: str, expected: str | None) -> None:
    assert nearest(word, ["friction", "coulomb", "stick"]) == expected


def test_a_name_that_holds_the_word_is_worth_more_than_one_that_looks_alike() -> None:
    assert nearest("energy", ["center_y[ball]", "kinetic_energy", "heat_energy"]) == "kinetic_energy"
    assert nearest("yield", ["field", "stress_yield[m]"]) == "stress_yield[m]"


def test_words() -> None:
    assert did_you_mean("colomb", ["coulomb"]) == "; did you mean 'coulomb'?"
    assert did_you_mean("nothing", ["coulomb"]) == ""
    assert listing(["a", "b"]) == "a, b"
    assert listing("abcdef", limit=2) == "a, b, …"


@pytest.mark.parametrize(
    ("word", "names", "expected"),
    [
        ("circle", ["box", "cylinder", "disk", "sphere"], "disk"),
        ("Rectangle", ["box", "disk", "sphere"], "box"),
        ("time-step", ["end", "courant", "step"], "step"),
        ("dt", ["end", "courant", "step"], "step"),
        ("dt", ["every", "fields"], "every"),
        ("mu", ["kind", "friction"], "friction"),
        ("mu", ["density", "E", "G"], "G"),
        ("circle", ["circles"], "circles"),
        ("circle", ["stick"], None),
    ],
)
def test_other_words(word: str, names: list[str], expected: str | None) -> None:
    """A word that people know for a name is worth more than one that looks alike."""
    assert nearest(word, names) == expected


def test_other_words_are_told_apart() -> None:
    assert all(words == words.lower() for words in OTHER_WORDS.values())
    for name, words in OTHER_WORDS.items():
        assert name.lower() not in words.split(), name
