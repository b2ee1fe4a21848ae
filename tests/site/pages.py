"""Pages of the documentation site, and the commands and code on them."""

import re
from pathlib import Path

from written_commands import blocks, command_blocks

SITE = Path(__file__).parents[2] / "reports" / "site"
PAGES = sorted(path for path in SITE.rglob("*.md") if path.name != "README.md")


def name_of(page: Path) -> str:
    return page.relative_to(SITE).with_suffix("").as_posix()


def commands(page: Path) -> list[list[str]]:
    """Return the commands of each block of a page that is to be typed into a terminal."""
    return command_blocks(page.read_text(encoding="utf-8"))


def code(page: Path) -> list[str]:
    """Return the cells of a page that the site's build executes, without how they are shown."""
    cells = blocks(page.read_text(encoding="utf-8"), "{code-cell}")
    return [re.sub(r"^:\w+:.*\n", "", cell, flags=re.MULTILINE) for cell in cells]
