"""Dimensional synthesis of linkages, cams and mechanisms from a target."""
