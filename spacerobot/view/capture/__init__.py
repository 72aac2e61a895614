"""Figures of one simulated capture."""
