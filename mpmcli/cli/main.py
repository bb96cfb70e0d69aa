"""The command ``mpmcli``: finds the command asked for, and ends with the exit code that fits."""

import importlib
import os
import sys
from collections.abc import Sequence

import click

from mpmcli.core.version import VERSION

# the command "run" lives in mpmcli.cli.run_command, imported when it is called
COMMANDS = {
    "run": "Run a scene.",
    "resume": "Continue a run from its last checkpoint.",
    "validate": "Report all problems of scenes.",
    "compile": "Compile the functions that scenes need.",
    "explain": "Report what a scene models, and its cost.",
    "schema": "Print the JSON Schema of scenes.",
    "list": "List the available materials, loads, … with their parameters.",
    "new": "Print or write a scene to start from.",
    "import": "Translate an input file of another program into a scene.",
    "compare": "Compare two tables or results folders.",
    "info": "Report the contents of a results folder.",
    "plot": "Draw the tables and particles of a results folder.",
    "cite": "Print BibTeX entries of the methods that a scene uses.",
    "stability": "Find the largest stable Courant numbers of a scene.",
    "tradeoff": "Measure cost and accuracy of variations of a scene.",
}

OUR_BUG = 70
INTERRUPTED = 130


class Commands(click.Group):
    """Commands that are imported when they are called, so that help comes at once."""

    def list_commands(self, context: click.Context) -> list[str]:
        """Names of the commands, in the order of their use."""
        return list(COMMANDS)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        """The command of this name."""
        if name not in COMMANDS:
            return None
        command: click.Command = importlib.import_module(f"mpmcli.cli.{name}_command").command
        return command

    def format_commands(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def resolve_command(
        self, context: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does, with the nearest name if there is no such command."""
        if args and not args[0].startswith("-") and args[0] not in COMMANDS:
            from mpmcli.core.suggest import nearest

            name = nearest(args[0], COMMANDS)
            hint = f" Did you mean '{name}'?" if name else f" Commands: {', '.join(COMMANDS)}."
            raise click.UsageError(f"There is no command '{args[0]}'.{hint}", context)
        return super().resolve_command(context, args)


@click.command(cls=Commands, context_settings={"help_option_names": ["-h", "--help"], "show_default": True})
@click.version_option(VERSION, message="%(prog)s %(version)s", help="Show the version.")
def mpmcli() -> None:
    """Simulate solids with the material point method, from one YAML file.

    Start with "mpmcli new -o scene.yaml", then "mpmcli run scene.yaml".
    """


def call(args: Sequence[str] | None = None) -> int:
    """Run a command line and return the exit code; every error becomes a message in words on stderr."""
    try:
        code = mpmcli.main(args=args, prog_name="mpmcli", standalone_mode=False)
        sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except click.exceptions.Exit as end:
        return end.exit_code
    except click.ClickException as error:
        error.show()
        return 2
    except (KeyboardInterrupt, click.Abort):
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except BrokenPipeError:
        # whoever read our output has seen enough; keep the interpreter from complaining at its end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:
        return _tell(error)


def _tell(error: Exception) -> int:
    """Say what went wrong on stderr; returns the exit code."""
    # imported here, because help needs none of it
    from mpmcli.core.errors import MpmcliError
    from mpmcli.core.plugins import installed

    if os.environ.get("MPMCLI_DEBUG") == "1" and (error.__cause__ or not isinstance(error, MpmcliError)):
        import traceback

        traceback.print_exception(error)
    if isinstance(error, MpmcliError):
        click.echo(str(error), err=True)
        return error.exit_code
    name = type(error).__name__
    click.echo(f"This is an error in mpmcli ({name}: {error}); please report it.", err=True)
    if plugins := ", ".join(map(str, installed())):
        click.echo(f"An installed plugin may have caused it: {plugins}.", err=True)
    click.echo("Set MPMCLI_DEBUG=1 to see the traceback.", err=True)
    return OUR_BUG


def main() -> None:
    """Entry point of the program."""
    sys.exit(call())


if __name__ == "__main__":
    main()
