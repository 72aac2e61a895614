"""Scenes, and the backends that integrate them: the reduced model and the full multibody."""
