"""Scenes to look at: films of robots, captures and recordings, shown by the viewer of meshcat in one page."""
