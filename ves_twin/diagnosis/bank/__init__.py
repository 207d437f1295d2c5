"""What each cause and each tolerance would change, simulated once, and ranked on a record."""
