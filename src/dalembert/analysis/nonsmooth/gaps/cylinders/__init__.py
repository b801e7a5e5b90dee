"""Features of cylinders."""
