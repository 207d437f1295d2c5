"""What a recording could tell before it is made, and which one would tell more."""
