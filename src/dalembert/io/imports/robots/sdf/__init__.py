"""Import of SDF, the format of Gazebo."""
