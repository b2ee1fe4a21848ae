"""Reports, one kind per file: from plain results to a document."""
