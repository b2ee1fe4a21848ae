"""`reliab monitor`: the error of a test while it runs."""

from reliab.cli.monitor.command import monitor

__all__ = ["monitor"]
