"""Time marching: fixed grids, adaptive steps, checkpoints."""
