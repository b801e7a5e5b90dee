"""Comparison of imported models with Pinocchio and MuJoCo."""
