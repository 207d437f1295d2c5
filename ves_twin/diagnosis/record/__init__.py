"""Recordings beside the runs that predict them: rows, noise, what is left."""
