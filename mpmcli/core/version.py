"""The version of mpmcli."""

VERSION = "0.1.0"
