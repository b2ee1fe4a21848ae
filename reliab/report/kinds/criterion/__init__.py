"""Report of criteria for tests, and of why there is none."""
