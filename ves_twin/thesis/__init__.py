"""thesis: the claims of the thesis, their verdicts and its figures."""
