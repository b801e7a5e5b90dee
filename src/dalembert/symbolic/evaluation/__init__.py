"""Who evaluates functions of the graph, and for how many arguments at once."""
