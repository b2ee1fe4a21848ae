"""Ask every external link of the project's texts whether it still answers; run by hand, not by the tests.

    python tests/site/external_links.py

Names each link that does not answer with its file, and ends with exit code 1 if there is one.
"""

import re
import sys
from pathlib import Path
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

ROOT = Path(__file__).parents[2]
TEXTS = ("*.md", "reports/**/*.md", "datasets/**/*.md", "reliab/**/*.md", "*.toml", "*.cff")
LINK = re.compile(r"https://[^\s<>\"'`)\]}…]+")
PATIENCE = 20.0
PRESENT_BUT_CLOSED = (401, 403, 405, 429)  # answers of sites that turn programs away


def links():
    """Return the files in which each link stands."""
    places = {}
    for path in sorted({path for pattern in TEXTS for path in ROOT.glob(pattern)}):
        for link in LINK.findall(path.read_text(encoding="utf-8")):
            places.setdefault(link.rstrip(".,;:"), set()).add(path.relative_to(ROOT).as_posix())
    return {link: sorted(files) for link, files in places.items() if "." in link.split("/")[2]}


def fault_of(link):
    """Return why a link does not answer; empty where it does."""
    request = Request(link, headers={"User-Agent": "reliab link check"})  # noqa: S310 - https only
    try:
        with urlopen(request, timeout=PATIENCE):  # noqa: S310
            return ""
    except HTTPError as error:
        return "" if error.code in PRESENT_BUT_CLOSED else f"{error.code} {error.reason}"
    except (URLError, TimeoutError) as error:
        return str(error)


def main():
    """Check all links."""
    places = links()
    faults = {link: fault for link in places if (fault := fault_of(link))}
    for link, fault in faults.items():
        sys.stdout.write(f"{link}: {fault} ({', '.join(places[link])})\n")
    sys.stdout.write(f"{len(places)} links, {len(faults)} without an answer\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
