"""Campaigns of a seven-joint arm that moves on its own, its joints logged, beside those with a wrist."""
