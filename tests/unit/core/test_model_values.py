"""Values of models: numbers, text with units, whole numbers, yes and no."""

from typing import Annotated

import pytest
from pydantic import Field, ValidationError

from mpmcli.core.descriptions import field_descriptions
from mpmcli.core.model import Model, Quantity, has_unit


class Sample(Model):
    """Some values."""

    size: Annotated[float, Quantity("length", gt=0)] = 1.0
    """A length."""
    count: int = Field(default=1, ge=1)
    """A whole number."""
    limit: int | None = None
    """A whole number or nothing."""
    is_open: bool = False
    """Yes or no."""


class Resolver:
    """Stands for a scene's units and constants."""

    constants = {"n": 3.0}

    def number(self, text: str, dimension: str) -> float:
        """A fixed table."""
        return {"2 mm/length": 2.0, "n/1": 3.0, "n/2/1": 1.5}[f"{text}/{dimension}"]


def test_values_are_read() -> None:
    sample = Sample.model_validate({"size": "2 mm", "count": "n", "is_open": True}, context=Resolver())
    assert (sample.size, sample.count, sample.is_open) == (2.0, 3, True)
    assert Sample(size="3/2", count=2.0).size == 1.5


@pytest.mark.parametrize(
    "values",
    [
        {"is_open": "no"},
        {"is_open": 1},
        {"count": True},
        {"count": "n/2"},
        {"count": 1.5},
        {"count": "many"},
        {"limit": False},
        {"size": True},
        {"size": float("nan")},
        {"size": float("inf")},
        {"size": 0},
        {"sise": 1},
    ],
)
def test_values_are_not_converted_into_each_other(values: dict[str, object]) -> None:
    class Half(Resolver):
        def number(self, text: str, dimension: str) -> float:
            if text == "n/2":
                return 1.5
            raise ValueError(f"'{text}' is not known")

    with pytest.raises(ValidationError) as caught:
        Sample.model_validate(values, context=Half())
    assert [error["loc"] for error in caught.value.errors()] == [(next(iter(values)),)]


@pytest.mark.parametrize("text", ["1 GPa", "1.5mm", "-3e-2 g/cc", "10 %", "5 1/s", "20 °C", "1e5 Pa"])
def test_text_with_unit(text: str) -> None:
    assert has_unit(text)


@pytest.mark.parametrize("text", ["1e3", "1/3", "2*R", "R", "3 - 4", "1 / s", "", "(1 GPa)", "-5", ".5"])
def test_text_without_unit(text: str) -> None:
    assert not has_unit(text)


class Special(Sample):
    """A sample with more."""

    size: float = 2.0
    """Another length,

    described at length.
    """
    silent: int = 0


def test_docstrings_below_fields_describe_them() -> None:
    words = field_descriptions(Special)
    assert words["size"] == "Another length,\n\ndescribed at length."
    assert words["count"] == "A whole number."
    assert "silent" not in words
    properties = Special.model_json_schema()["properties"]
    assert properties["count"]["description"] == "A whole number."
    assert "description" not in properties["silent"]
