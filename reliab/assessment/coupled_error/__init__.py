"""The error of a test with several actuators: each interface displacement's, with intervals and parts."""
