"""Pages of decisions, as plain data."""
