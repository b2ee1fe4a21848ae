"""What the tests of a rig teach: a robust hierarchical model, beside two simpler ones."""
