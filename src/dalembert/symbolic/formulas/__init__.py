"""Formulas: expressions, parameters, tables and their text grammar."""
