"""Registries: a table says which module holds which kind, and a kind is imported when it is named."""

import importlib
import sys
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import pytest
from pydantic import BaseModel, TypeAdapter, ValidationError

from mpmcli.core.registry import OneOf, Registry, discover
from mpmcli.scene.alternatives import ALTERNATIVES

ANIMAL = """
from typing import Literal
from pydantic import BaseModel
from zoo import ANIMALS

@ANIMALS.register
class {name}(BaseModel):
    kind: Literal[{kinds}]
    legs: int
"""


@pytest.fixture
def zoo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Registry:
    """A registry with a cat, and a raven that goes by two names."""
    package = tmp_path / "zoo"
    package.mkdir()
    (package / "__init__.py").write_text(
        "from mpmcli.core.registry import Registry\nTABLE = {'cat': 'cat', 'crow': 'birds', 'raven': 'birds'}\n"
        "ANIMALS = Registry('animal', 'zoo', TABLE)\n"
    )
    (package / "cat.py").write_text(ANIMAL.format(name="Cat", kinds='"cat"'))
    (package / "birds.py").write_text(ANIMAL.format(name="Raven", kinds='"crow", "raven"'))
    (package / "food.py").write_text("raise RuntimeError('nobody asked for food')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield importlib.import_module("zoo").ANIMALS
    for name in [name for name in sys.modules if name.partition(".")[0] == "zoo"]:
        del sys.modules[name]


@pytest.mark.parametrize("word", ALTERNATIVES)
def test_the_table_is_that_of_the_code(word: str) -> None:
    """Every module of its packages is imported: what registers itself stands in the table, in its own module."""
    registry = ALTERNATIVES[word]
    table = {kind: registry.module_of(kind) for kind in registry}
    assert len(table) > 1
    for package in {name.rpartition(".")[0] for name in table.values()}:
        discover(package, importlib.import_module(package).__path__)
    assert {kind: registry[kind].__module__ for kind in registry} == table
    for kind in registry:
        model = registry[kind]
        assert kind in get_args(model.model_fields["kind"].annotation)
    registered = {
        kind for model in registry.models() for kind in get_args(model.model_fields["kind"].annotation)
    }
    assert registered == set(registry)


def test_only_what_is_named_is_imported(zoo: Registry) -> None:
    assert list(zoo) == ["cat", "crow", "raven"]
    assert "raven" in zoo
    assert "dog" not in zoo
    adapter = TypeAdapter(dict[str, Annotated[Any, OneOf(zoo)]])
    assert adapter.validate_python({"Tom": {"kind": "cat", "legs": 4}})["Tom"].legs == 4
    assert "zoo.cat" in sys.modules
    assert "zoo.birds" not in sys.modules
    assert [model.__name__ for model in zoo.models()] == ["Cat", "Raven"]


def test_what_is_wrong_has_its_place(zoo: Registry) -> None:
    adapter = TypeAdapter(list[Annotated[Any, OneOf(zoo)]])
    wrong = [
        {"kind": "cat", "legs": "many"},
        {"kind": "dog"},
        {"legs": 2},
        "cat",
        {"kind": ["cat"]},
        {"kind": None},
    ]
    with pytest.raises(ValidationError) as caught:
        adapter.validate_python(wrong)
    found = [(error["type"], error["loc"]) for error in caught.value.errors()]
    assert found == [
        ("int_parsing", (0, "cat", "legs")),
        ("union_tag_invalid", (1,)),
        ("union_tag_not_found", (2,)),
        ("model_attributes_type", (3,)),
        ("union_tag_invalid", (4,)),
        ("union_tag_not_found", (5,)),
    ]
    assert caught.value.errors()[1]["ctx"]["expected_tags"] == "'cat', 'crow', 'raven'"


def test_a_model_may_stand_for_itself(zoo: Registry) -> None:
    raven = zoo["raven"](kind="raven", legs=2)
    assert TypeAdapter(Annotated[Any, OneOf(zoo)]).validate_python(raven) is raven


def test_a_kind_that_the_table_lacks_is_refused(zoo: Registry, tmp_path: Path) -> None:
    (tmp_path / "zoo" / "dog.py").write_text(ANIMAL.format(name="Dog", kinds='"dog"'))
    with pytest.raises(ValueError, match="animal 'dog' is not in the table of its registry"):
        importlib.import_module("zoo.dog")


def test_a_name_is_taken_once(zoo: Registry) -> None:
    class Cat(BaseModel):
        kind: Literal["cat"]

    with pytest.raises(ValueError, match="animal 'cat' is registered twice"):
        zoo.register(Cat)
    assert "zoo.cat" not in sys.modules
