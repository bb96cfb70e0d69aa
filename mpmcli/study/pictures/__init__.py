"""Pictures of results: tables over time, particles at a time, animations, a script for ParaView."""

from mpmcli.study.pictures.request import Request, plot

__all__ = ["Request", "plot"]
