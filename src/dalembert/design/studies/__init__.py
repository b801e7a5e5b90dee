"""Many designs of one model: which, where they are computed, and what is kept of them."""
