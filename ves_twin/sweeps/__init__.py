"""Sweeps: one scenario at many settings, on several cores or a cluster, as one table."""
