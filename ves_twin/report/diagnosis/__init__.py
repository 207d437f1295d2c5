"""report: a verdict as one HTML page and in sentences."""
