"""A prediction: what an MJCF machine does, or which efforts its motion takes."""
