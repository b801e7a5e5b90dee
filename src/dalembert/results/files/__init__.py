"""Results as plain data, in files and pages."""
