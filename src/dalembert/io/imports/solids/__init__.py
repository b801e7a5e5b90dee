"""Import of solids with their inertia: CAD models in STEP files, and meshes."""
