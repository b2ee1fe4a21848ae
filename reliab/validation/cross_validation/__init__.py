"""Cross-validation grouped by earthquake."""
