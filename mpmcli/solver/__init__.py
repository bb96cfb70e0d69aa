"""What a scene needs, and the time step that runs it."""
