"""Materials that soften refuse cells in which a crack would release more energy than it dissipates."""

import pytest
import yaml

from mpmcli.core.errors import SceneError
from mpmcli.scene.filling import check_filling
from mpmcli.scene.loader import load_scene


def scene(cell, kind_of_analysis="plane_strain", **changes):
    brittle = {
        "kind": "isotropic_softening", "density": 1.0, "E": 1000.0, "nu": 0.2, "strength": 1.0, "toughness": 1e-3,
    }  # fmt: skip
    return load_scene(
        yaml.safe_dump(
            {
                "version": 1,
                "analysis": {"kind": kind_of_analysis},
                "grid": {"lower": [0, 0], "upper": [12, 12], "cell": cell},
                "materials": {"glass": brittle | changes},
                "bodies": [
                    {
                        "name": "a",
                        "material": "glass",
                        "region": {"kind": "box", "lower": [3, 3], "upper": [9, 9]},
                    }
                ],
                "time": {"end": 1},
            }
        )
    ).scene


@pytest.mark.parametrize(
    ("softening", "cell", "limit"), [("linear", 3, "2 .2 E·tough"), ("exponential", 1.5, "1 .E·tough")]
)
def test_too_large_cells_are_refused(softening, cell, limit):
    with pytest.raises(SceneError, match=rf"(?s)materials\.glass .*smaller than {limit}"):
        check_filling(scene(cell, softening=softening))
    check_filling(scene(cell / 2, softening=softening))


def test_axisymmetric_analyses_are_refused():
    """A radial crack is no ring."""
    with pytest.raises(SceneError, match=r"axisymmetric"):
        scene(1, kind_of_analysis="axisymmetric")


def test_the_row_with_the_least_toughness_is_named(tmp_path):
    """Numbers of particles: the widest band is that of each row."""
    rows = ["3.5,3.5,1,1,1e-3", "4.5,3.5,1,0.5,1e-4", "5.5,3.5,1,1,1e-3"]
    (tmp_path / "p.csv").write_text("\n".join(["x,y,volume,strength,toughness", *rows]) + "\n")
    loaded = scene(1)
    plain = loaded.model_dump(mode="json", exclude_unset=True)
    plain["bodies"][0]["region"] = {"kind": "points", "file": "p.csv"}
    for cell, refused in ((1, True), (0.75, False)):
        plain["grid"]["cell"] = cell
        (tmp_path / "scene.yaml").write_text(yaml.safe_dump(plain))
        given = load_scene(tmp_path / "scene.yaml").scene
        if refused:
            with pytest.raises(SceneError, match=r"(?s)p\.csv', line 3, .*smaller than 0\.8 "):
                check_filling(given)
        else:
            check_filling(given)
