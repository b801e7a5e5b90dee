"""Joint coordinates: kinematic tree of bodies and joints."""
