"""Numbers with units, their dimensions, and the grammar of formulas."""
