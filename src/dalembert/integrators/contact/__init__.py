"""Steps with impacts and friction: which contacts act, and with which impulses."""
