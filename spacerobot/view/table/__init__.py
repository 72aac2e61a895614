"""Verdicts of many studies in one table."""
