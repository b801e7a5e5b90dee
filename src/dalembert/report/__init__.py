"""Reports of a simulation run."""
