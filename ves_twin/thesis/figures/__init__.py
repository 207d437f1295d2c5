"""figures: the figures of the thesis, drawn anew, each with the numbers it stands for."""
