"""How large the emulation error is, where it comes from, and learning it away."""
