from .command import AssessDemand as AssessDemand, assess as assess, only_value as only_value
