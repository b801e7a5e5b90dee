"""Import of MJCF, the format of MuJoCo."""
