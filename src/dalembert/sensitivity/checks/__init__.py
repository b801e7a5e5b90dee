"""Whether a gradient is right and means something: differences, certificates, notes."""
