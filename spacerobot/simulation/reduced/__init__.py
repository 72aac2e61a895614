"""The reduced backend: constant masses, scalar ports, compiled; a trial in about a millisecond."""
