"""Single steps of a model between inputs and outputs, for controllers and learning."""
