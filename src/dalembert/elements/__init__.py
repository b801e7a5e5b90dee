"""Bodies, joints, drivers and forces, stated by position-level equations or virtual power."""
