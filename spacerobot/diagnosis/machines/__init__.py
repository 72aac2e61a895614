"""Machines that a fit can run: the contract, the wrist rig, and each machine without a wrist."""
