"""Sizes of causes by the full simulation, thresholds, how sure each is."""
