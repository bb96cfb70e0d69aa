"""Coverage-guided fuzzing of the scene loader with atheris, which is no dependency: ``pip install atheris``, then

    python tests/fuzz/fuzz_loader.py -max_total_time=600

Scenes of ``inputs/`` and the corpus of broken scenes are where it starts; all options are libFuzzer's. It ends at the
first text that gives anything but a scene or a ``SceneError``, and leaves that text in a file ``crash-…``.
"""

import json
import os
import sys
import tempfile
from pathlib import Path

import atheris

ROOT = Path(__file__).parents[2]
os.chdir(ROOT / "inputs")  # the pictures that scenes name

with atheris.instrument_imports(
    include=["mpmcli.scene", "mpmcli.core.expressions", "mpmcli.core.model", "yaml"]
):
    from mpmcli.core.errors import SceneError
    from mpmcli.output.of_scene import check_output
    from mpmcli.scene.loader import load_scene


def read(data: bytes) -> None:
    """Read some bytes as a scene, as ``mpmcli validate`` does."""
    text = data.decode("utf-8", errors="replace") + "\n"
    try:
        loaded = load_scene(text)
        check_output(loaded.scene)
        assert loaded.hash
    except SceneError:
        return


def main() -> None:
    """Fuzz until libFuzzer's options say to stop."""
    with tempfile.TemporaryDirectory() as folder:
        for path in [*ROOT.glob("inputs/*.yaml"), *ROOT.glob("tests/broken_scenes/*.yaml")]:
            (Path(folder) / path.name).write_bytes(path.read_bytes())
        words = set(json.loads((ROOT / "schemas" / "scene.schema.json").read_text())["properties"])
        for definition in json.loads((ROOT / "schemas" / "scene.schema.json").read_text())[
            "definitions"
        ].values():
            words |= set(definition.get("properties", ()))
        dictionary = Path(folder).with_suffix(".dict")
        dictionary.write_text("".join(f'"{word}: "\n' for word in sorted(words)))
        atheris.Setup([*sys.argv, f"-dict={dictionary}", "-timeout=20", "-rss_limit_mb=4096", folder], read)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
