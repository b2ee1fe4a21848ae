"""Physical terms of a general kind, which give an effect outside the library an expression."""
