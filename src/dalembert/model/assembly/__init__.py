"""From guesses to a start that satisfies every joint and driver."""
