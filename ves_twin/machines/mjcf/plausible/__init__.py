"""What a machine's file cannot be right about, by recordings and before any fit."""
