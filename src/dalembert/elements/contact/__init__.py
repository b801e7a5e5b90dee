"""Contact: shapes, normal force laws, friction and restitution."""
