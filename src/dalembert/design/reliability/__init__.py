"""How often random parameters break a limit: design points, corrections, sampling."""
