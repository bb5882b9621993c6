"""Where mechanisms come from: robot files and parametric builders, all ending in a MuJoCo model."""
