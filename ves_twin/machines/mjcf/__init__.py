"""Any plant: an MJCF file and one TOML file, as the diagnosis and compare see it."""
