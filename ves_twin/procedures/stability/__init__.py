"""Which rigs are stable: maps, growth, one axis, plants that agree with measured poles."""
