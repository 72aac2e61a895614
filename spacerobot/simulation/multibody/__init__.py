"""The multibody backend: the robot in Pinocchio, its joints and base really moving, the target a free body."""
