"""Where forces balance, and small motions about a state."""
