"""`reliab criterion`: how much amplitude error and delay a test may have."""

from reliab.cli.criterion.command import criterion

__all__ = ["criterion"]
