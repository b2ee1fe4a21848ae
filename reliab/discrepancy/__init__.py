"""Measured campaigns: locate the discrepancy, name what is missing, add it, prove that the gap shrank."""

from reliab.discrepancy.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.reading import read_campaign
from reliab.discrepancy.result import BlockDiagnosis, Diagnosis, Gap, MissingEffect, Verdict

__all__ = [
    "BlockDiagnosis",
    "Campaign",
    "Channel",
    "Diagnosis",
    "Gap",
    "MeasuredTest",
    "MissingEffect",
    "Verdict",
    "diagnose",
    "read_campaign",
]
