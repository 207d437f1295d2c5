"""A machine's file: what it says, held against its model, and written back with what was found."""
