"""The catalogue: one effect a file; every module here that defines an Effect is found by `effects.registry`."""
