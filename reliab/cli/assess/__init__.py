"""`reliab assess`: the verdict on a test, or what is tolerable before one."""

from reliab.cli.assess.command import assess

__all__ = ["assess"]
