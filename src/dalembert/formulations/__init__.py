"""Formulations of the constrained equations and stabilisations of their constraints."""
