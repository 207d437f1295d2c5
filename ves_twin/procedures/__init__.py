"""procedures: experiments of many runs with one result."""
