"""Pages of the documentation site, and the commands and code on them."""

import re
from pathlib import Path

SITE = Path(__file__).parents[2] / "reports" / "site"
INSTALL = "python -m pip install"  # what the test's own environment has already
PAGES = sorted(path for path in SITE.rglob("*.md") if path.name != "README.md")


def name_of(page: Path) -> str:
    return page.relative_to(SITE).with_suffix("").as_posix()


def commands(page: Path) -> list[list[str]]:
    """Return the commands of each block of a page that is to be typed into a terminal."""
    blocks = re.findall(r"```console\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    lines = [[line.removeprefix("$ ") for line in block.splitlines()] for block in blocks]
    return [[line for line in block if not line.startswith(INSTALL)] for block in lines]


def code(page: Path) -> list[str]:
    """Return the cells of a page that the site's build executes."""
    return re.findall(r"```\{code-cell\}\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)
