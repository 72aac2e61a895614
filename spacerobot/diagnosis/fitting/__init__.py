"""From a hypothesis to its best fit, and what the fit leaves."""
