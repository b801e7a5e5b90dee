"""Steps of free bodies with balls and walls in machine code."""
