"""comparison: where a measured recording and a plant part, in sigma and in SI."""
