"""What a rigid-body model says at a pose: effective mass, floating base, impact."""
