"""A comparison of recording and machine as one HTML page and in sentences."""
