"""Flexible bodies: geometrically exact beams, and reduced structures in a floating frame."""
