"""Benches: small plants beside VES II that the diagnosis is tried on."""
