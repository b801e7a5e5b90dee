"""Results of structures: states under loads, modes, motions; their pictures and tables."""
