"""One plain sentence for each method: whether it keeps the share that it states, and of which motions."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from reliab.significant import percent


def kept_shares(
    rows: Sequence[Mapping[str, Any]], of_side: str = "", whose: str = "the motions"
) -> Iterator[str]:
    """Say of each method and law whether the share that it states is kept, and by which motions.

    >>> rate = {"rate": 0.52, "low": 0.41, "high": 0.63}
    >>> rows = [{"candidate": "power", "confidence": 0.95, "containment": rate}]
    >>> print(*kept_shares(rows))
    power does not keep the share that it states: it protects 52.0 % of the motions where it states 95 %.
    """
    for candidate in dict.fromkeys(row["candidate"] for row in rows):
        judged = [
            (row["containment"], row["confidence"])
            for row in rows
            if row["candidate"] == candidate and row["containment"]["rate"] is not None
        ]
        if not judged:
            continue
        shares = ", ".join(
            f"{percent(rate['rate'], decimals=1)} where it states {percent(stated, decimals=0)}"
            for rate, stated in judged
        )
        first, *others = shares.split(" where", 1)
        yield f"{candidate} {_keeps(judged)}{of_side}: it protects {first} of {whose} where{others[0]}."


def _keeps(judged: Sequence[tuple[Mapping[str, Any], float]]) -> str:
    """Whether shares are kept, as far as their intervals can tell."""
    below = [(rate, stated) for rate, stated in judged if rate["rate"] < stated]
    broken = [
        percent(stated, decimals=0) for rate, stated in below if (rate["high"] or rate["rate"]) < stated
    ]
    if broken:
        at = f" at {', '.join(broken)}" if len(judged) > 1 else ""
        return f"does not keep the share that it states{at}"
    if below:
        return "may keep the share that it states, as far as so few motions can tell"
    return "keeps the share that it states"
