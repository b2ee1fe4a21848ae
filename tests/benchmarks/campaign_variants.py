"""Harder campaigns: nominal values that are wrong, few tests, short ones, and noisy channels."""

import re
from collections.abc import Callable
from pathlib import Path

SHORT = 5.0
"""Length of a short record [s]."""

NOISY_DB = 15.0
"""Signal-to-noise ratio of noisy channels, the middle of 10 to 20 dB."""


def _scaled(key: str, factor: float) -> Callable[[Path], None]:
    def change(campaign: Path) -> None:
        file = campaign / "campaign.toml"
        text = file.read_text(encoding="utf-8")
        pattern = rf"^({key} = )(\S+)$"
        file.write_text(
            re.sub(pattern, lambda m: f"{m[1]}{factor * float(m[2])!r}", text, flags=re.MULTILINE),
            encoding="utf-8",
        )

    return change


def _shortened(campaign: Path) -> None:
    """Keep the strongest five seconds of every test, which then begins in motion."""
    for file in campaign.glob("*.csv"):
        header, *rows = file.read_text(encoding="ascii").splitlines()
        values = [abs(float(row.split(",")[-1])) for row in rows]
        step = float(rows[1].split(",")[0]) - float(rows[0].split(",")[0])
        length = min(round(SHORT / step), len(rows))
        middle = max(range(len(values)), key=values.__getitem__)
        begin = min(max(middle - length // 2, 0), len(rows) - length)
        kept = [row.split(",", 1)[1] for row in rows[begin : begin + length]]
        lines = [header, *(f"{k * step:.12g},{row}" for k, row in enumerate(kept))]
        file.write_text("\n".join(lines) + "\n", encoding="ascii")


def _of_two_tests(campaign: Path) -> None:
    """Keep the first test and the last one, which is held out."""
    file = campaign / "campaign.toml"
    head, *tests = file.read_text(encoding="utf-8").split("[[tests]]")
    first, last = (re.sub(r"held_out = \w+", "held_out = false", test) for test in (tests[0], tests[-1]))
    text = "[[tests]]".join([head, first, last.replace("held_out = false", "held_out = true")])
    file.write_text(text, encoding="utf-8")


VARIANTS: dict[str, Callable[[Path], None]] = {
    "frequency": _scaled("frequency_hz", 1.02),
    "damping": _scaled("damping_ratio", 1.2),
    "mass": _scaled("mass_kg", 1.02),
    "short": _shortened,
    "two_tests": _of_two_tests,
    "noisy": lambda _campaign: None,
}
"""What is changed in the folder of a campaign, by name; noise is drawn by the laboratory itself."""
