from .command import assess as assess
from .judging import JudgesTests as JudgesTests, files_of as files_of, only_value as only_value
