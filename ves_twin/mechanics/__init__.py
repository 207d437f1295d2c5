"""Closed-form mechanics of rig and arm, without MuJoCo: kinematics, beams, gravity, planning."""
