"""Laws of frequency and damping, one per file; each refuses use outside its validity."""
