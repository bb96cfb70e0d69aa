"""Registries: the named alternatives (``kind:``) of a scene, each in a file of its own.

A registry has a table of its kinds and the module of each, so that a module is imported when a scene names its kind.
"""

import importlib
import pkgutil
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any, get_args

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticKnownError, SchemaValidator, core_schema


class Registry:
    """Models told apart by their literal ``kind`` field.

    Parameters
    ----------
    noun
        What an entry is called in messages, e.g. ``"material"``.
    package
        The package of its modules, e.g. ``"mpmcli.materials"``.
    table
        The module in the package of each kind; kinds of plugins come on top.
    lack
        Says what a model lacks to be an entry; nothing if it is one.
    """

    def __init__(
        self,
        noun: str,
        package: str,
        table: Mapping[str, str],
        lack: Callable[[type[Any]], str] = lambda model: "",
    ):
        self.noun = noun
        self._lack = lack
        self._entries: dict[str, type[BaseModel]] = {}
        self._package = package
        self._modules = {kind: f"{package}.{module}" for kind, module in table.items()}

    def register(self, model: type[Any]) -> type[Any]:
        """Class decorator: add a model under each name of its literal ``kind`` field."""
        lack = self._lack(model)
        if lack:
            raise TypeError(f"{model.__name__} is not a {self.noun}: {lack}")
        for kind in get_args(model.model_fields["kind"].annotation):
            if kind not in self and model.__module__.startswith(f"{self._package}."):
                raise ValueError(f"{self.noun} '{kind}' is not in the table of its registry")
            if kind in self._entries or self._modules.setdefault(kind, model.__module__) != model.__module__:
                raise ValueError(f"{self.noun} '{kind}' is registered twice")
            self._entries[kind] = model
        return model

    def __getitem__(self, kind: str) -> type[BaseModel]:
        if kind not in self._entries:
            importlib.import_module(self._modules[kind])
        return self._entries[kind]

    def module_of(self, kind: str) -> str:
        """Return the name of the module that registers a kind."""
        return self._modules[kind]

    def __contains__(self, kind: object) -> bool:
        return kind in self._modules

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._modules))

    def models(self) -> list[type[BaseModel]]:
        """Every registered model once, ordered by name."""
        return list(dict.fromkeys(self[kind] for kind in self))


class OneOf:
    """Marks a value that must be an entry of a registry: ``Annotated[Any, OneOf(MATERIALS)]``.

    Only the entry that the value names is imported.
    """

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
