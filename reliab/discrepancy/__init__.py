"""Measured campaigns: locate a discrepancy, name the missing effect, add it, verify on held-out tests."""

from reliab.discrepancy.adding.adding import Addition, add
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.campaign.folder import campaign_folder
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Verdict
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.result.gap import Gap
from reliab.discrepancy.result.missing_effect import MissingEffect

__all__ = [
    "Addition",
    "BlockDiagnosis",
    "Campaign",
    "Channel",
    "Diagnosis",
    "Gap",
    "MeasuredTest",
    "MissingEffect",
    "Verdict",
    "add",
    "campaign_folder",
    "diagnose",
    "read_campaign",
]
