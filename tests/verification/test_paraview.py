"""ParaView without a screen follows the README's recipe and runs our script; its pictures are like stored ones.

``MPMCLI_STORE_PICTURES=1`` stores them anew.
"""

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mpmcli.cli.main import call

ROOT = Path(__file__).parents[2]
DATA = ROOT / "tests" / "data"
SIZE = (480, 200)
TOLERANCE = 8.0
"""Mean difference of pictures that show the same, where there is more than background [8-bit colours]."""
SCENE = ("--set", "grid.cell=2", "--until", "0.045", "-q", "--overwrite")
STEPS = {
    "open `particles.pvd`": """
        reader = OpenDataFile({pvd!r})
        view = GetActiveViewOrCreate("RenderView")
        view.ViewSize = {size!r}""",
    "*Apply*": """
        shown = Show(reader, view)
        scene = GetAnimationScene()
        scene.UpdateAnimationUsingDataTimeSteps()
        ResetCamera(view)
        Render(view)""",
    "*Point Gaussian*": """
        shown.SetRepresentationType("Point Gaussian")""",
    "colour by `pressure`": """
        ColorBy(shown, ("POINTS", "pressure"))
        shown.RescaleTransferFunctionToDataRange(True, False)
        shown.SetScalarBarVisibility(view, True)
        Render(view)
        write_range("pressure")""",
    "*Rescale to Data Range Over All Timesteps*": """
        shown.RescaleTransferFunctionToDataRangeOverTime()
        write_range("pressure")""",
    "*Play*": """
        scene.GoToLast()
        Render(view)""",
}
"""What ParaView does where the README says so."""
BEGIN = """
from paraview.simple import *

def write_range(array):
    points = GetColorTransferFunction(array).RGBPoints
    print("range", points[0], points[-4])
"""
END = """
view = GetActiveViewOrCreate("RenderView")
view.OrientationAxesVisibility = 0
view.ViewSize = {size!r}
GetActiveCamera().Zoom(1.8)
SaveScreenshot({path!r}, view, ImageResolution={size!r})
"""


def recipe_of(page: str) -> list[str]:
    """The steps of a page's recipe, in its order; every word in italics must be one."""
    text = " ".join((ROOT / page).read_text(encoding="utf-8").split())
    recipe = text[text.index("**ParaView**: open") : text.index("*Play*") + len("*Play*")]
    places = {recipe.find(step): step for step in STEPS}
    assert -1 not in places, (page, places[-1])
    assert set(re.findall(r"(?<!\*)\*[^*]+\*(?!\*)", recipe)) <= set(STEPS)
    return [places[place] for place in sorted(places)]


@pytest.mark.parametrize("page", ["README.md", "docs/start.md"])
def test_the_recipe_is_the_one_that_is_tried(page):
    assert recipe_of(page) == list(STEPS)


@pytest.fixture(scope="module")
def screen() -> Iterator[dict[str, str]]:
    """The environment of a ParaView that draws on a screen which nobody sees."""
    missing = [program for program in ("pvpython", "Xvfb") if shutil.which(program) is None]
    if missing:
        pytest.skip(f"not installed: {', '.join(missing)} (Debian: python3-paraview, xvfb)")
    command = ["Xvfb", "-displayfd", "1", "-noreset", "-screen", "0", "1280x1024x24"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as server:
        assert server.stdout is not None
        number = server.stdout.readline().strip()  # it is written when the screen is there
        assert number, "Xvfb has not started"
        kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        yield kept | {"DISPLAY": f":{number}", "LIBGL_ALWAYS_SOFTWARE": "1"}
        server.terminate()


@pytest.fixture(scope="module")
def impact(tmp_path_factory) -> Path:
    """Two blocks, from rest to the largest pressure."""
    directory = tmp_path_factory.mktemp("paraview") / "block_impact"
    assert call(["run", str(ROOT / "inputs" / "block_impact.yaml"), *SCENE, "-o", str(directory)]) == 0
    return directory


def draw(text: str, path: Path, screen: dict[str, str]) -> str:
    """Run a script in ParaView, save what is to be seen, and return what was printed."""
    script = path.with_suffix(".py")
    script.write_text(text + END.format(size=list(SIZE), path=str(path)))
    done = subprocess.run(
        ["pvpython", str(script)], env=screen, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert path.exists(), done.stderr
    return done.stdout


def colors_of(path: Path) -> np.ndarray:
    """Colours of a picture, blurred so that single points count little."""
    with Image.open(path) as image:
        small = image.convert("RGB").resize((SIZE[0] // 4, SIZE[1] // 4), Image.Resampling.BOX)
    return np.asarray(small, dtype=float)


def assert_like_the_stored_one(path: Path, name: str) -> None:
    """The picture is the stored one, but for what renderers do differently."""
    stored = DATA / name
    if os.environ.get("MPMCLI_STORE_PICTURES"):
        with Image.open(path) as image:
            image.convert("RGB").quantize(64, dither=Image.Dither.NONE).save(stored, optimize=True)
    found, expected = colors_of(path), colors_of(stored)
    assert difference(found, expected) < TOLERANCE
    # the comparison sees what was wrong once: all particles of one colour
    background = found[0, 0]
    is_drawn = np.abs(found - background).max(axis=2) > 20.0
    flat = np.where(is_drawn[:, :, None], np.median(found[is_drawn], axis=0), background)
    assert difference(flat, expected) > 2.0 * TOLERANCE


def difference(found: np.ndarray, expected: np.ndarray) -> float:
    """Mean difference of the colours where either picture shows more than background."""
    is_drawn = (np.abs([found - found[0, 0], expected - expected[0, 0]]) > 20.0).any(axis=(0, 3))
    return float(np.abs(found - expected)[is_drawn].mean())


@pytest.mark.slow
def test_the_recipe_of_the_readme(impact, screen, tmp_path):
    steps = [STEPS[step].replace("\n        ", "\n") for step in recipe_of("README.md")]
    text = BEGIN + "".join(steps).format(pvd=str(impact / "particles.pvd"), size=list(SIZE))
    printed = draw(text, tmp_path / "recipe.png", screen)
    ranges = [tuple(map(float, line.split()[1:])) for line in printed.splitlines() if "range" in line]
    (_, at_rest), (low, high) = ranges
    assert at_rest < 1.0, "the first archive, at rest, has an endless range"
    assert -200.0 < low < -1.0
    assert 100.0 < high < 400.0
    assert_like_the_stored_one(tmp_path / "recipe.png", "paraview_recipe.png")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "options"), [("script", []), ("script_pressure", ["--color", "pressure", "--time", "0.03"])]
)
def test_the_script(impact, screen, tmp_path, name, options):
    script = tmp_path / "open.py"
    assert call(["plot", str(impact), "--paraview", *options, "-o", str(script)]) == 0
    draw(script.read_text(), tmp_path / f"{name}.png", screen)
    assert_like_the_stored_one(tmp_path / f"{name}.png", f"paraview_{name}.png")


@pytest.mark.slow
def test_a_quantity_that_follows_from_the_stress(impact, screen, tmp_path):
    """The script calculates it where it is not archived: the picture is that of the archived one."""
    other = tmp_path / "derived"
    scene = str(ROOT / "inputs" / "block_impact.yaml")
    fields = ("--set", "archive.particles.fields=[stress]")
    assert call(["run", scene, *SCENE, *fields, "-o", str(other)]) == 0
    script = tmp_path / "open.py"
    options = ["--paraview", "--color", "pressure", "--time", "0.03", "-o", str(script)]
    assert call(["plot", str(other), *options]) == 0
    assert "Calculator" in script.read_text()
    draw(script.read_text(), tmp_path / "derived.png", screen)
    assert_like_the_stored_one(tmp_path / "derived.png", "paraview_script_pressure.png")
