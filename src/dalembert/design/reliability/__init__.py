"""Structural reliability: design points, first- and second-order methods, sampling."""
