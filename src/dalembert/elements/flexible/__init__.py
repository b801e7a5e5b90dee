"""What bends: beams that bend far, and structures that deform by few shapes in a floating frame."""
