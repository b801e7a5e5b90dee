"""Motions with many impacts, steps in which contact and friction are solved at once."""
