"""Results of comparisons, as tables and pictures."""
