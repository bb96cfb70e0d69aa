"""Wires a simulation to its outputs."""
