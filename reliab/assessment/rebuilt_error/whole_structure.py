"""The former name of the structure whose test is rebuilt."""

from reliab.structures import CoupledPartition

WholeStructure = CoupledPartition
"""Former name of :class:`~reliab.structures.CoupledPartition`, which ends with version 0.4."""
