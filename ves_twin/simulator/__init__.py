"""The simulator: a compiled inner loop, plain Python outside."""
