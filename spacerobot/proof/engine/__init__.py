"""Campaigns from MuJoCo: nothing here shares code with the simulator or the catalogue that are put to the test."""
