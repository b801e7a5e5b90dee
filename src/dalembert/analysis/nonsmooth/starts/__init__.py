"""Positions at the start of runs with contacts: small gaps closed, and overlaps refused."""
