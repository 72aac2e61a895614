"""Physics, one effect a file, each written once as an edit of a mechanism into primitives."""
