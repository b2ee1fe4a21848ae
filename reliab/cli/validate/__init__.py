"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from reliab.cli.validate.command import validate

__all__ = ["validate"]
