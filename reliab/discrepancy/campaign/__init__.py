"""A measured campaign: its tests, its nominal model, and how both are read."""
