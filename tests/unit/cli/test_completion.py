"""What shells offer for a word that is begun."""

import os
import subprocess
import sys

import pytest
from click.shell_completion import BashComplete

from mpmcli.cli.main import mpmcli
from mpmcli.cli.plot_command import WHAT
from mpmcli.results.pictures.quantities import colorings
from mpmcli.results.reading import Results
from mpmcli.scene.shipped import shipped


def offered(args: list[str], begun: str = "") -> list[str]:
    """What bash is told."""
    items = BashComplete(mpmcli, {}, "mpmcli", "_MPMCLI_COMPLETE").get_completions(args, begun)
    return [item.value for item in items]


def test_names_of_scenes():
    assert offered(["new"]) == list(shipped())
    assert offered(["new"], "sim") == ["simple"]


def test_quantities_are_those_that_plot_takes(make_results):
    directory = make_results()
    results = Results(directory)
    names = list(colorings(results.frame(results.path_of(-1))))
    assert offered(["plot", str(directory), "--color"]) == names
    assert {"pressure", "stress_xy", "velocity", "body", "position_x"} <= set(names)
    assert offered(["plot", str(directory), "--color"], "stress_x") == ["stress_xx", "stress_xy", "stress_xz"]


def test_columns_of_tables(make_results):
    directory = str(make_results())
    for option in ("--column", "--x"):
        assert offered(["plot", directory, option], "mom") == ["momentum_x"]
        assert offered(["plot", directory, option], "tip:v") == ["tip:velocity_x"]
    assert offered(["plot", directory, "--column"], "dt,mom") == ["dt,momentum_x"]
    assert offered(["compare", directory, directory, "--columns"], "vel") == ["velocity_x"]
    assert offered(["compare", f"{directory}/globals.csv", directory, "--columns"], "vel") == []


def test_words_and_commands():
    assert offered(["plot", "x", "--what"]) == list(WHAT)
    assert offered(["plot", "x", "--what"], "energies,str") == ["energies,stresses", "energies,strains"]
    assert offered([], "sta") == ["stability"]
    assert "quantities" in offered(["list"])


@pytest.mark.parametrize(
    "damage", ["nothing", "particles.pvd", "particles/particles_000002.vtu", "globals.csv"]
)
def test_what_cannot_be_read_offers_nothing(make_results, damage, capfd):
    directory = make_results()
    if damage == "nothing":
        directory = directory / "nowhere"
    else:
        (directory / damage).write_bytes(b"\xff<")
    for option in ("--color", "--column", "--x"):
        assert isinstance(offered(["plot", str(directory), option]), list)
    assert offered(["plot", str(directory / "nowhere"), "--color"]) == []
    assert capfd.readouterr() == ("", "")


def test_the_program_answers_a_shell(make_results):
    words = f"mpmcli plot {make_results()} --color von"
    asked = {"_MPMCLI_COMPLETE": "bash_complete", "COMP_WORDS": words, "COMP_CWORD": "4"}
    command = [sys.executable, "-c", "from mpmcli.cli.main import main; main()"]
    done = subprocess.run(command, env=os.environ | asked, capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("plain,von_mises\n", "")
