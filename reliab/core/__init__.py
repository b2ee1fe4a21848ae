"""What every room rests on: errors, files, registries, units, and numbers in sentences."""
