"""A robot whose joints a person drags: sliders beside the scene, answered by Pinocchio."""
