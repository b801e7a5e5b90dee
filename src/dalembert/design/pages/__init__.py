"""Pages of the results of design tasks, as plain data."""
