"""Machines as the diagnosis sees them: VES II, any MJCF machine, static poses, a pendulum."""
