"""An example of a plugin of mpmcli: one alternative per file, announced in pyproject.toml."""
