"""How driven mechanisms move, and what moves them."""
