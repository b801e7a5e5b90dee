"""Nonsmooth contact dynamics by time stepping."""
