"""Kinematics of platform and arm, without MuJoCo."""
