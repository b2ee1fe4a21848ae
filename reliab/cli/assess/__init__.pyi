from .command import assess as assess
