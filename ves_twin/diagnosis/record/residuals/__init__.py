"""Residuals of one channel: noise, cells, spectrum, lag and coherence."""
