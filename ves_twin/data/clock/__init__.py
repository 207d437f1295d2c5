"""Clocks of logs: which column, offsets between files, rows at an even rate."""
