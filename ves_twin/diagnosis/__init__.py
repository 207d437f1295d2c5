"""Diagnosis: what a simulation gets wrong, from measured data. Knows no plant, only `Forward`."""
