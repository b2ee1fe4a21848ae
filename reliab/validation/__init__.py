"""Does the criterion hold: cross-validation, other rigs, and the verdict on a test."""
