"""Registries: the named alternatives (``kind:``) of a scene, each in a file of its own.

A room reads once which of its files hold which kinds (``Registry.discover``), so that a new alternative is one new
file; it is imported when a scene names it.
"""

from __future__ import annotations

import importlib
import pkgutil
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Annotated, Any, get_args

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticKnownError, SchemaValidator, core_schema

_ENTRY = r"^@{}\.register\nclass .*?^    kind: Literal\[([^\]]*)\]"


class Registry:
    """Models told apart by their literal ``kind`` field.

    Parameters
    ----------
    noun
        What an entry is called in messages, e.g. ``"material"``.
    variable
        The name of the registry in the files of its entries, e.g. ``"MATERIALS"``.
    lack
        Says what a model lacks to be an entry; nothing if it is one.
    """

    def __init__(self, noun: str, variable: str, lack: Callable[[type[Any]], str] = lambda model: ""):
        self.noun = noun
        self._lack = lack
        self._pattern = re.compile(_ENTRY.format(variable), re.MULTILINE | re.DOTALL)
        self._entries: dict[str, type[BaseModel]] = {}
        self._modules: dict[str, str] = {}

    def discover(self, package: str, path: list[str]) -> None:
        """Learn from the text of a package's modules which of them holds which entry: none is imported."""
        for folder in path:
            for module in pkgutil.iter_modules([folder]):
                name, source = f"{package}.{module.name}", Path(folder, f"{module.name}.py")
                if not source.is_file():  # installed without sources
                    importlib.import_module(name)
                    continue
                for kinds in self._pattern.findall(source.read_text(encoding="utf-8")):
                    self._modules |= dict.fromkeys(re.findall(r'"([^"]*)"', kinds), name)

    def register(self, model: type[Any]) -> type[Any]:
        """Class decorator: add a model under each name of its literal ``kind`` field."""
        lack = self._lack(model)
        if lack:
            raise TypeError(f"{model.__name__} is no {self.noun}: {lack}")
        for kind in get_args(model.model_fields["kind"].annotation):
            if kind in self._entries or self._modules.setdefault(kind, model.__module__) != model.__module__:
                raise ValueError(f"{self.noun} '{kind}' is registered twice")
            self._entries[kind] = model
        return model

    def __getitem__(self, kind: str) -> type[BaseModel]:
        if kind not in self._entries:
            importlib.import_module(self._modules[kind])
        return self._entries[kind]

    def __contains__(self, kind: object) -> bool:
        return kind in self._modules

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._modules))

    def models(self) -> list[type[BaseModel]]:
        """Every registered model once, ordered by name."""
        return list(dict.fromkeys(self[kind] for kind in self))

    def union(self) -> Any:
        """The pydantic type "one of these, told apart by kind"."""
        return Annotated[Any, OneOf(self)]


class OneOf:
    """What pydantic does with a value that must be an entry of a registry: only the entry it names is imported."""

    def __init__(self, registry: Registry):
        self.registry = registry
        self._validator_of = cache(self._validator)

    def models(self) -> list[type[BaseModel]]:
        """All that the value may be."""
        return self.registry.models()

    def _validator(self, kind: str) -> SchemaValidator:
        schema = self.registry[kind].__pydantic_core_schema__
        return SchemaValidator(core_schema.tagged_union_schema({kind: schema}, discriminator="kind"))

    def _validate(self, value: Any, info: core_schema.ValidationInfo) -> Any:
        if not isinstance(value, dict | BaseModel):
            raise PydanticKnownError("model_attributes_type")
        kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", None)
        if kind is None:
            raise PydanticKnownError("union_tag_not_found", {"discriminator": "'kind'"})
        if not isinstance(kind, str) or kind not in self.registry:
            expected = ", ".join(f"'{name}'" for name in self.registry)
            details = {"discriminator": "'kind'", "tag": str(kind), "expected_tags": expected}
            raise PydanticKnownError("union_tag_invalid", details)
        return self._validator_of(kind).validate_python(value, context=info.context)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """A mark, where ``scene.schema`` puts the entries."""
        return {"x-one-of": self.registry.noun}


def discover(package: str, path: list[str]) -> None:
    """Import every module of a package, so that its entries register themselves."""
    for module in sorted(pkgutil.iter_modules(path), key=lambda m: m.name):
        importlib.import_module(f"{package}.{module.name}")
