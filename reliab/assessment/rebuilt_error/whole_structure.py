"""The former name of the structure whose test is rebuilt."""

from reliab.structures import Partition

WholeStructure = Partition
"""Former name of :class:`~reliab.structures.Partition`, which ends with version 0.4."""
