"""Files for other programs, written from models and results."""
