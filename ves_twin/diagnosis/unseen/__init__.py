"""Recordings that no fit has seen, and what an extended model is worth there."""
