"""Studies: what a lab believes about its rig, and what it recorded."""
