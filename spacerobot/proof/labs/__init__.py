"""Rigs of other labs: other springs, masses, speeds, instruments and directions than the one the diagnosis grew on."""
