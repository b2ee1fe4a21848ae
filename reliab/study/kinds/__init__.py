"""What studies do, one kind per file."""
