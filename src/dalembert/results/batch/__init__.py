"""Results of many designs at once."""
