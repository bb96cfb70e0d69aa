"""Between particles and grid: stencils, gathers and scatters, nodal fields, the full-mass loop."""
