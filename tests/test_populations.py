"""Every sentence that promises a share of ground motions says of which ones."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
READ = {".py", ".md", ".html", ".js", ".toml", ".typ"}
SHARE = r"(?:[Ss]hares?|[Pp]ercent\([\w.]+\)\}|\d ?%|%\})"
UNSTATED_POPULATION = re.compile(
    rf"{SHARE} of (?:all |real )*ground\s+motions\b(?! (?:like|behind|of|that ship))"
)


def texts():
    folders = (ROOT / name for name in ("reliab", "studies", "reports", "datasets"))
    for path in [ROOT / "README.md", *(path for folder in folders for path in folder.rglob("*"))]:
        if path.suffix in READ and path.is_file():
            yield path.relative_to(ROOT), path.read_text(encoding="utf-8")


def test_no_share_of_ground_motions_is_promised_without_their_population():
    promises = [
        f"{name}: {match[0]}" for name, text in texts() for match in UNSTATED_POPULATION.finditer(text)
    ]
    assert not promises


def test_the_scan_finds_such_sentences_and_spares_others():
    assert UNSTATED_POPULATION.search("for 95 % of real ground motions, whatever")
    assert UNSTATED_POPULATION.search('f"{share:.0%} of ground motions"')
    assert not UNSTATED_POPULATION.search("95 % of the population's ground motions")
    assert not UNSTATED_POPULATION.search("95 % of ground motions like the hundred that ship")
