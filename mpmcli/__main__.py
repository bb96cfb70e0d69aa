"""``python -m mpmcli``: the command line."""

from mpmcli.cli.main import main

if __name__ == "__main__":
    main()
