"""quality: whether a recording can be trusted before anything is concluded from it."""
