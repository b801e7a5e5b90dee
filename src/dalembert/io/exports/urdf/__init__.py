"""URDF, the format of robotics."""
