"""Physical terms outside the library, which give an unknown effect an expression."""
