"""Laws of frequency and damping, one per file."""

from reliab.criterion.laws.law import Law
from reliab.criterion.laws.one_structure import OneStructure
from reliab.criterion.laws.serialisation import LAWS, law_from_dict, law_to_dict
from reliab.criterion.laws.validity import Validity

__all__ = ["LAWS", "Law", "OneStructure", "Validity", "law_from_dict", "law_to_dict"]
