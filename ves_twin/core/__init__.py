"""What every room stands on: errors, units, signals, recordings, whole files, plugins."""
