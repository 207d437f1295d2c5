"""linear: transfer functions of the loops with python-control, sampled where the rig is."""
