"""The numbers of a scene, or of a part of one, as nested dictionaries and lists."""

import copy
from collections.abc import Iterator
from typing import Any


def numbers_in(keys: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The path of each number."""
    if isinstance(keys, dict | list):
        for key, value in keys.items() if isinstance(keys, dict) else enumerate(keys):
            yield from numbers_in(value, (*path, key))
    elif not isinstance(keys, str | bool) and keys is not None:
        yield path


def with_number(keys: Any, path: tuple[Any, ...], value: Any) -> Any:
    """A copy with one number in place of another."""
    keys = copy.deepcopy(keys)
    place = keys
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return keys
