"""From fitted models to the names that the data support."""
