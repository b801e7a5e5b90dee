"""Flexible bodies: structures that move with a floating frame and deform in it by few shapes."""
