"""gravity_model: the wrench of gravity for any serial arm, and its identification."""
