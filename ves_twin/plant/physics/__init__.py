"""Compiled kernels of the hardware: one device a file, with its parameters and its state."""
