"""Assembly: from guesses to an initial state that satisfies all joints and drivers."""
