"""The thesis's figures, each drawn by one function."""
