"""Readers of a test's file, one format per file, chosen by what the file's first bytes say."""
