"""Which column of a log is which signal, in which frame and unit."""
