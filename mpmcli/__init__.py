"""mpmcli: a material point method simulator driven by YAML scenes."""

__version__ = "0.1.0"
