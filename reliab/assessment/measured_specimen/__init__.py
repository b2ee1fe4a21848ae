"""The error of a test whose specimen nobody can model: what it does is learned from its own force."""
