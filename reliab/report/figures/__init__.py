"""Figures, one subject to a file: from finished results to a matplotlib figure."""
