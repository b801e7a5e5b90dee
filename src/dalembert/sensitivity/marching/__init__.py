"""Direct and adjoint gradients through the time steps of a run."""
