"""Interfaces of design problems to other packages."""
