"""Blind suites: recordings with a hidden effect, the truth sealed, and the marking of answers."""
