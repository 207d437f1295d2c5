"""Pendulum: one link on a hinge, the smallest machine of the diagnosis."""
