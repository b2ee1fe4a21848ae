"""Simulator of a hybrid test, as a closed loop or block by block."""
