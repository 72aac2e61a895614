"""Rivals on the same files, each used as its own documentation advises."""
