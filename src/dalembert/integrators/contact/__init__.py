"""Nonsmooth time stepping: contact schemes and solvers for contact impulses."""
