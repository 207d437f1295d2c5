"""Scenarios: validated TOML files, each the answer to one question."""
