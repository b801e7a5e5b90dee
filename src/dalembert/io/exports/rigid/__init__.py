"""Mechanisms as trees of rigid bodies with hinges and slides, for formats of robotics."""
