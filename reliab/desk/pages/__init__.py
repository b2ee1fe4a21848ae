"""Pages of the desk, one file each."""

from typing import Final

from reliab.desk.page import Page
from reliab.desk.pages.before import DesignPage, RigPage
from reliab.desk.pages.diagnose import DiagnosePage
from reliab.desk.pages.judge import ComparePage, JudgePage, LivePage

PAGES: Final[tuple[type[Page], ...]] = (JudgePage, DesignPage, LivePage, ComparePage, RigPage, DiagnosePage)
"""Pages in the order of the menu."""
