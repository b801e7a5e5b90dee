"""Inverse problems: identification of force and drive histories from measured motion."""
