"""The scene: YAML text to a checked, resolved model."""
