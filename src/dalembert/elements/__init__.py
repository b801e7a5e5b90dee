"""Bodies, joints, drivers and forces: each states its position-level equation or its work."""
