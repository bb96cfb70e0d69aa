"""What is wrong with a scene whose text is changed piece by piece."""

from __future__ import annotations

from collections.abc import Iterable

from mpmcli.core.errors import Problem, SceneError
from mpmcli.scene.loader import load_scene


def changed(text: str, *changes: tuple[str, str]) -> str:
    """A text in which each piece, which is there once, is replaced."""
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def problems_of(text: str, sets: Iterable[str] = ()) -> list[Problem]:
    """Errors of a scene, or warnings of one that is valid."""
    try:
        return load_scene(text, sets=tuple(sets)).warnings
    except SceneError as error:
        return error.problems
