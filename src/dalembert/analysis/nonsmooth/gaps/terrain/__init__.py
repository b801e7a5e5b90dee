"""Features of height fields."""
