"""The plant: a frozen description of the physical rig and its MuJoCo model."""
