"""Effective mass made visible: along a path, over the workspace, over frequency, and where a capture is soft."""
