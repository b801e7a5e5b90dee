"""Expressions, parameters, factorisations and implicit functions on the CasADi graph."""
