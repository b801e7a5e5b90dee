"""Texts of new models."""

UNTITLED = 'format = 1\nname = "untitled"\ngravity = [0.0, -9.81]\n'
"""Text of a new model."""
UNTITLED_SPATIAL = UNTITLED.replace("[0.0, -9.81]", "[0.0, 0.0, -9.81]")
"""Text of a new spatial model."""
UNTITLED_STRUCTURE = 'format = 1\nkind = "structure"\nname = "untitled"\n'
"""Text of a new structure."""
UNTITLED_SPATIAL_STRUCTURE = UNTITLED_STRUCTURE + "gravity = [0.0, 0.0, 0.0]  # without weight\n"
"""Text of a new spatial structure."""
NEW = {
    (False, False): UNTITLED,
    (False, True): UNTITLED_SPATIAL,
    (True, False): UNTITLED_STRUCTURE,
    (True, True): UNTITLED_SPATIAL_STRUCTURE,
}
"""Whether it is a structure, whether it is spatial → text of a new model."""
