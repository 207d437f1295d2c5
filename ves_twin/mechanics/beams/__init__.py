"""beams: stiffness, mass and damping of the flexible structures that the rig emulates."""
