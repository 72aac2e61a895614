"""Whole machines: a chaser that floats, its seven joints free or on servos, and all of it recorded."""
