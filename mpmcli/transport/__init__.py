"""Quantities that are conducted through bodies; temperature is the first."""
