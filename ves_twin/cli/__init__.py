"""The command line: ves-twin."""
