from .block_diagnosis import BlockDiagnosis as BlockDiagnosis, Verdict as Verdict
from .diagnosis import Diagnosis as Diagnosis
from .gap import Gap as Gap, Remainder as Remainder
from .missing_effect import MissingEffect as MissingEffect, Unknown as Unknown
