"""Documentation that states a share of ground motions says of which ones."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "studies/README.md", *sorted((ROOT / "reports/site").rglob("*.md"))]
BARE = re.compile(r"\d ?% of (?:all |real )*(?:ground )?motions\b(?! (?:like|that|of|whose|behind|with))")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_share_of_motions_names_its_population(page):
    text = " ".join(page.read_text(encoding="utf-8").split())
    assert [text[max(0, hit.start() - 60) : hit.end() + 30] for hit in BARE.finditer(text)] == []
