"""Independent verification of a design: MuJoCo, energy, and the poses between the samples."""
