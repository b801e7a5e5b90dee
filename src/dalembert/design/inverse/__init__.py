"""Unknown histories from what they cause: forces and drives from measured motion."""
