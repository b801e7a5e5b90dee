"""Texts for users: wording, spelling suggestions, cards of notebooks."""
