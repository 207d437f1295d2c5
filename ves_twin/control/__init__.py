"""What runs on the computers: controllers, references and what they believe of the rig."""
