"""Robots, wrists and spacecraft as Pinocchio models: reading, checking and assembling URDFs."""
