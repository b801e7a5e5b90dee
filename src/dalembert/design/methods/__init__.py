"""Ways to an optimum, one in a file; ``registry`` lists them."""
