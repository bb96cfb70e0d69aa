"""Largest stable time steps: a small block on the grid, its update linearised, and what that says of a scene."""
