"""Joint coordinates: the tree of bodies that joints carry."""
