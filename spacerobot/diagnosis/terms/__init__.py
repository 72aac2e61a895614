"""What all rooms speak in: the data, a hypothesis, its free parameters."""
