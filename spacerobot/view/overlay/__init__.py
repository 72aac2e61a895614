"""A study's simulation laid over its recordings: figures and page."""
