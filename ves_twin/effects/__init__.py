"""effects: named deviations of a rig from its description, which diagnosis looks for."""
