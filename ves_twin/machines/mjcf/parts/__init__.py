"""Bodies, joints and inertias of an MJCF model, and what follows from them alone."""
