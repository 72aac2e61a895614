"""Where simulation and recording part, and which physics was left out."""
