"""Texts for users: wording, checks of arguments, cards of notebooks."""
