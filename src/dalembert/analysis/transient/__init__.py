"""Time integration of structures: equations, start, steps, march."""
