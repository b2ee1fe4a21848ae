"""Every number of the paper's Tables 1 to 6 and equations (11) to (18), recomputed."""

from reliab.paper.audit import audit

__all__ = ["audit"]
