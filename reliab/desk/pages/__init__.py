"""Pages of the desk, one file each."""

from typing import Final

from reliab.desk.page import Page
from reliab.desk.pages.before import DesignPage
from reliab.desk.pages.compare import ComparePage
from reliab.desk.pages.diagnose import DiagnosePage
from reliab.desk.pages.judge import JudgePage
from reliab.desk.pages.live import LivePage
from reliab.desk.pages.rig import RigPage

PAGES: Final[tuple[type[Page], ...]] = (JudgePage, DesignPage, LivePage, ComparePage, RigPage, DiagnosePage)
"""Pages in the order of the menu."""
