"""What every layer may use: errors, JSON, files, progress. Imports nothing of the project."""
