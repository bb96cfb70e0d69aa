"""What turns text of a scene into numbers: handed to every model while it reads its values."""

from functools import cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import TypeAdapter

from mpmcli.core.expression_functions import Table
from mpmcli.core.expressions import number_in
from mpmcli.core.model import has_unit
from mpmcli.core.registry import OneOf
from mpmcli.scene.units import Units, split_unit


class Context:
    """Units and constants of a scene, and where its files lie.

    Attributes
    ----------
    units : the scene's units
    constants : values of its constants by name
    base_directory : folder of the scene, where the files that it names are looked for
    allow_outside_files : whether it may name files outside that folder
    function_files : names of the files that its expressions read
    """

    def __init__(
        self,
        units: Units,
        constants: dict[str, float],
        base_directory: Path | None = None,
        allow_outside_files: bool = False,
    ):
        self.units = units
        self.constants = constants
        self.base_directory = base_directory or Path.cwd()
        self.allow_outside_files = allow_outside_files
        self.function_files: set[str] = set()

    def number(self, text: str, dimension: str) -> float:
        """The value of text in the scene's units; ValueError with words for the user.

        Parameters
        ----------
        text : a number with a unit, or an expression of constants
        dimension : words such as ``"pressure"`` or ``"energy/mass"``
        """
        if has_unit(text):
            try:
                return self.units.number(text, dimension)
            except ValueError as error:
                parts = split_unit(text)
                if parts is not None and parts[1] in self.constants:
                    raise ValueError(f"'{text}' needs an operator: write {parts[0]}*{parts[1]}") from None
                raise error
        return number_in(text, self.constants)

    def table(self, name: str) -> Table:
        """The points (2, n) of a function in a file; ValueError with words for the user."""
        from mpmcli.geometry.files import find_file
        from mpmcli.geometry.function_files import read_function

        path = find_file(name, self).path
        self.function_files.add(name)
        return read_function(path)

    def region(self, value: Any) -> Any:
        """A region model made from a scene's mapping."""
        return _any_region().validate_python(value, context=self)


@cache
def _any_region() -> TypeAdapter[Any]:
    from mpmcli.geometry import REGIONS

    return TypeAdapter(Annotated[Any, OneOf(REGIONS)])
