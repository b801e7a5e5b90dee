"""Many alike elements evaluated at once, and their sums."""
