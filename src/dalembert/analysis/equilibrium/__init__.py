"""Statics: equilibria of mechanisms and structures, linear statics, load paths."""
