"""Studio: a local page in which a model file is drawn and written, with a live picture of it."""
