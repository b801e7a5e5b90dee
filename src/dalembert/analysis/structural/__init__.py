"""Analyses of structures: statics, load paths, vibration, buckling, transients."""
