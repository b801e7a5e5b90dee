"""Design problems as other packages want them."""
