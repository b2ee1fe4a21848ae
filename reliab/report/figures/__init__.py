"""Figures, one file each: from finished results to a matplotlib figure."""
