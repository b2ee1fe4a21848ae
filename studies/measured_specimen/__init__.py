"""Whether a specimen that nobody models is learned from its own force well enough to judge its test."""
