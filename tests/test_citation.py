"""What those who cite the package read: the citation file, and a summary of the length that journals take."""

import re
from pathlib import Path

from reliab.version import __version__

ROOT = Path(__file__).parents[1]
MOST_WORDS = 1000  # of the summary, without its head


def test_the_citation_states_this_version():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"version: {__version__}\n" in citation
    released = re.search(r"^date-released: (\S+)$", citation, re.MULTILINE)[1]
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"## [{__version__}] - {released}\n" in changes


def test_the_summary_has_the_sections_and_the_length_of_a_software_journal():
    _, head, text = (ROOT / "reports" / "summary.md").read_text(encoding="utf-8").split("---\n", maxsplit=2)
    assert "authors:" in head
    sections = re.findall(r"^# (.*)$", text, re.MULTILINE)
    assert {"Summary", "Statement of need", "Comparison with other software", "References"} <= set(sections)
    assert len(text.split()) <= MOST_WORDS
