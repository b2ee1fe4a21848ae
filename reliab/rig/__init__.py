"""A laboratory's memory: the tests of a rig, what they teach of it, the next one predicted, drift noticed."""
