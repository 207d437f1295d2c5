"""Measured frequency responses, steps and positioning errors."""
