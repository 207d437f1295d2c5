"""Readers of log files: each a table of columns in blocks."""
