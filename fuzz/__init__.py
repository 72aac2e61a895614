"""Fuzzing of every reader: no traceback, no hang, no gigabyte, no file outside the folder it was given."""
