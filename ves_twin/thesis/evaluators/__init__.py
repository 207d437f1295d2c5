"""What the twin gives for each claim, a file per chapter."""
