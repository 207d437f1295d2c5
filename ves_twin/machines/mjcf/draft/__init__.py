"""The machine file that `ves-twin new` drafts from a model and a log."""
