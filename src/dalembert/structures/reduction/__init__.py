"""Structures by few shapes: Craig–Bampton modes, and the frames that bodies of them float in."""
