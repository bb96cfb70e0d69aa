"""What a run leaves behind, read: tables and particles, facts, comparisons, pictures."""
