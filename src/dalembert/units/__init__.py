"""Numbers with units, their dimensions, and formulas in text."""
