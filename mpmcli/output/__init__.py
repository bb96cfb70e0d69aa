"""What a run leaves behind: particle archives, tables, manifest."""
