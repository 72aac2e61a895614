"""Forward models of a study's baseline, one a file: what it expects each trial to have recorded."""
