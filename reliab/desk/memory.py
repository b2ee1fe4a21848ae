"""What a page remembers while its browser tab is reloaded, apart for each tab that was opened anew."""

import re
import secrets
import threading
from collections import OrderedDict
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from reliab.desk.jobs import Job

_KEY: Final = re.compile(r"[A-Za-z0-9_-]{16,64}")
_MOST_TABS: Final = 50


@dataclass(kw_only=True, eq=False)
class PageMemory:
    """What one page of one tab remembers."""

    values: dict[str, Any] = field(default_factory=dict)  # Of its fields
    files: list[Path] = field(default_factory=list)  # That were dropped on it
    jobs: dict[str, Job] = field(default_factory=dict)  # By what they are for
    place: Path | None = None  # Folder of its results


class Memories:
    """Pages by tab; the tabs that were not used for longest are forgotten first."""

    def __init__(self) -> None:
        self._tabs: OrderedDict[str, dict[str, PageMemory]] = OrderedDict()
        self._lock = threading.Lock()

    def find_tab(self, key: str) -> tuple[str, dict[str, PageMemory]]:
        """Return the pages of a tab by its key, which is made where it is none that the desk gave."""
        with self._lock:
            if not _KEY.fullmatch(key) or key not in self._tabs:
                key = secrets.token_urlsafe(16)
                self._tabs[key] = {}
            self._tabs.move_to_end(key)
            while len(self._tabs) > _MOST_TABS:
                self._tabs.popitem(last=False)
            return key, self._tabs[key]
