from .adding.adding import Addition as Addition, add as add
from .campaign.campaign import Campaign as Campaign, Channel as Channel, MeasuredTest as MeasuredTest
from .campaign.reading import campaign_folder as campaign_folder, read_campaign as read_campaign
from .diagnose import diagnose as diagnose
from .result.block_diagnosis import BlockDiagnosis as BlockDiagnosis, Verdict as Verdict
from .result.diagnosis import Diagnosis as Diagnosis
from .result.gap import Gap as Gap
from .result.missing_effect import MissingEffect as MissingEffect
