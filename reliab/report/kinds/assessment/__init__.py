"""Reports of one measured test, of one mass or of a frame."""
