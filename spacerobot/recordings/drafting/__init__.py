"""A first study from a folder of recordings: what the files, their names and their readings say by themselves."""
