"""Logs as recordings of an MJCF machine, cut, split and held against it."""
