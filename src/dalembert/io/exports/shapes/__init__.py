"""Shapes of bodies as surfaces and lines, from the scenes of pictures."""
