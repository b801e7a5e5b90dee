"""XML files: elements with line numbers, read without external entities."""
