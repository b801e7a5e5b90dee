"""Steps of free bodies with balls, convex hulls and walls in machine code."""
