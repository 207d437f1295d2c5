"""What an MJCF machine could be fed next, and sensors that it could have."""
