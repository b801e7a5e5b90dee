"""What people read: wording, the nearest name, cards of notebooks."""
