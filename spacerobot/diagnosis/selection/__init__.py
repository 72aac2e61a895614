"""Which hypotheses are fitted, kept, and believed."""
