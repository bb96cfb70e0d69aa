"""Studies that run a scene many times or compare what runs left."""
