"""Paths of the arm that leave a flexible base at rest, tried on the rig."""
