"""Files that may be read, and files that appear whole or not at all."""
