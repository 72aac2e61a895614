"""Exact propagation of piecewise linear rigs: matrix exponentials between events; many collisions a compiled call."""
