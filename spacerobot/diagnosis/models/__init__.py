"""Models that let one diagnosis run on many recordings: joints, axes, free bodies, arms."""
