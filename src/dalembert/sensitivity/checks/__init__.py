"""Verification of gradients: finite differences, certificates, notes."""
