"""The demo's picture: the arm, the collision, and a simulation laid over a recording."""
