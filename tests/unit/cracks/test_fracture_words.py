"""Words of the section fracture."""

import pytest
from pydantic import ValidationError

from mpmcli.cracks.fracture import Fracture


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"inner": 2, "outer": 2.5}, r"outer\n.*must be at least one cell more than inner, 2, but is 2.5"),
        ({"size": 3}, r"size\n.*belongs to 'integral: contour'"),
        ({"integral": "contour", "size": 0}, "greater than or equal to 1"),
        ({"terms": 3}, "Input should be 1 or 2"),
        ({"every": -1}, "greater than or equal to 0"),
    ],
)
def test_refusals(keys, words):
    with pytest.raises(ValidationError, match=words):
        Fracture.model_validate(keys)


def test_size_of_a_contour():
    assert Fracture(integral="contour").half == 3
    assert Fracture(integral="contour", size=5).half == 5
