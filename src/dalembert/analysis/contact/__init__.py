"""Rigid contacts in time: impacts, lasting contact, sticking and sliding."""
