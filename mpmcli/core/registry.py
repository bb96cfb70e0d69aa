"""Registries: the named alternatives (``kind:``) of a scene, each in a file of its own.

A room imports its own files once (``discover``), so that a new alternative is one new file.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from typing import Annotated, Any, Union, get_args

from pydantic import BaseModel, Field


class Registry:
    """Models told apart by their literal ``kind`` field.

    Parameters
    ----------
    noun
        What an entry is called in messages, e.g. ``"material"``.
    """

    def __init__(self, noun: str):
        self.noun = noun
        self._entries: dict[str, type[BaseModel]] = {}

    def register(self, model: type[Any]) -> type[Any]:
        """Class decorator: add a model under each name of its literal ``kind`` field."""
        for kind in get_args(model.model_fields["kind"].annotation):
            if kind in self._entries:
                raise ValueError(f"{self.noun} '{kind}' is registered twice")
            self._entries[kind] = model
        return model

    def __getitem__(self, kind: str) -> type[BaseModel]:
        return self._entries[kind]

    def __contains__(self, kind: object) -> bool:
        return kind in self._entries

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._entries))

    def models(self) -> list[type[BaseModel]]:
        """Every registered model once, ordered by name."""
        return list(dict.fromkeys(self._entries[kind] for kind in self))

    def union(self) -> Any:
        """The pydantic type "one of these, told apart by kind"."""
        models = self.models()
        if len(models) == 1:
            return models[0]
        return Annotated[Union[tuple(models)], Field(discriminator="kind")]  # noqa: UP007


def discover(package: str, path: list[str]) -> None:
    """Import every module of a package, so that its entries register themselves."""
    for module in sorted(pkgutil.iter_modules(path), key=lambda m: m.name):
        importlib.import_module(f"{package}.{module.name}")
