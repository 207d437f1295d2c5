"""Recordings: named signals on one clock, in memory and in files."""
