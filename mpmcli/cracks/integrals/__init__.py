"""Fracture quantities at a tip from the particles around it: energy release rate and stress intensity factors."""
