"""Model order reduction of structures: Craig–Bampton modes, floating frames."""
