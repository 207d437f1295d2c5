"""Machines of measured public data, made as a user would make them: a model and one TOML file."""
