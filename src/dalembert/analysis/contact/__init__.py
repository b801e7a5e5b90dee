"""Rigid contacts: impacts, lasting contact, sticking and sliding."""
