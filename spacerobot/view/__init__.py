"""Scenes, figures and pages for people."""
