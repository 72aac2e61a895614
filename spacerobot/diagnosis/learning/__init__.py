"""Laws that no catalogue holds: a curve at a port, fitted inside the simulation."""
