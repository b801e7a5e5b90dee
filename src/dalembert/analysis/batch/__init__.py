"""Many designs of one model in one call."""
