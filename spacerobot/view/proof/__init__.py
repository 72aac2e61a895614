"""The page of the proof bench and its figures."""
