"""Does the criterion hold: cross-validation, the paper's cases, and the verdict on a test."""
