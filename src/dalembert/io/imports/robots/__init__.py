"""Robots and other mechanisms of links and joints: URDF, MJCF and SDF."""
