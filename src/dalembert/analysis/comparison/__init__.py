"""The same motion by many formulations and integrators, side by side."""
