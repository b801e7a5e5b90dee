"""From step to step: grids, control of errors, checkpoints."""
