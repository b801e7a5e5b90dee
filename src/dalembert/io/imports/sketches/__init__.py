"""Import of planar mechanisms from drawings: lines are bars, circles are pins."""
