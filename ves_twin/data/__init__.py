"""Measured data: lab files read in pieces, inspected, mapped, imported and exported."""
