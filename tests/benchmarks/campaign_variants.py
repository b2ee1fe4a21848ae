"""Other campaigns: wrong nominal values, few tests, short ones, noisy channels, fewer channels."""

import math
import re
from collections.abc import Callable, Collection
from pathlib import Path

from blind_campaigns.outcomes import WRONG_STRUCTURE

SHORT = 5.0
"""Length of a short record [s]."""

NOISY_DB = 15.0
"""Signal-to-noise ratio of noisy channels, the middle of 10 to 20 dB."""

SAMPLES = 110_000
"""Samples of a campaign of two blocks."""

FORCE_OFFSET = "force_offset"
MIXED_VARIANT = "mixed"
_OFFSET = 0.1  # of the RMS of a test's force
_EVERY_THIRD = 3
_FORCE_BIAS = "force_bias"


def _scale_value(key: str, factor: float) -> Callable[[Path], None]:
    def change(campaign: Path) -> None:
        file = campaign / "campaign.toml"
        structure, *tables = file.read_text(encoding="utf-8").partition("[specimen]")
        pattern = rf"^({key} = )(\S+)$"
        new_text = re.sub(pattern, lambda m: f"{m[1]}{factor * float(m[2])!r}", structure, flags=re.MULTILINE)
        file.write_text("".join([new_text, *tables]), encoding="utf-8")

    return change


def _shorten(campaign: Path) -> None:
    """Keep the strongest five seconds of every test, which then begins in motion."""
    for file in campaign.glob("*.csv"):
        header, *rows = file.read_text(encoding="ascii").splitlines()
        values = [abs(float(row.split(",")[-1])) for row in rows]
        step = float(rows[1].split(",")[0]) - float(rows[0].split(",")[0])
        length = min(round(SHORT / step), len(rows))
        middle = max(range(len(values)), key=values.__getitem__)
        begin = min(max(middle - length // 2, 0), len(rows) - length)
        new_rows = [row.split(",", 1)[1] for row in rows[begin : begin + length]]
        lines = [header, *(f"{k * step:.12g},{row}" for k, row in enumerate(new_rows))]
        file.write_text("\n".join(lines) + "\n", encoding="ascii")


def _keep_two_tests(campaign: Path) -> None:
    """Keep the first test and the last one, which is held out."""
    file = campaign / "campaign.toml"
    head, *tests = file.read_text(encoding="utf-8").split("[[tests]]")
    first, last = (re.sub(r"held_out = \w+", "held_out = false", test) for test in (tests[0], tests[-1]))
    text = "[[tests]]".join([head, first, last.replace("held_out = false", "held_out = true")])
    file.write_text(text, encoding="utf-8")


def _add_force_offset(campaign: Path) -> None:
    """Add a constant to the recorded force, which the loop did not feel."""
    offset = None
    for file in sorted(campaign.glob("*.csv")):
        header, *rows = file.read_text(encoding="ascii").splitlines()
        if not header.endswith(",force_n"):
            return
        split = [row.rsplit(",", 1) for row in rows]
        if offset is None:
            offset = _OFFSET * math.sqrt(sum(float(force) ** 2 for _, force in split) / len(split))
        new_rows = [f"{start},{float(force) + offset:.12g}" for start, force in split]
        file.write_text("\n".join([header, *new_rows]) + "\n", encoding="ascii")


def _keep_two_blocks(campaign: Path) -> None:
    """Keep so many samples, and no ground acceleration, so that actuator and specimen alone are observed."""
    rows = {file: file.read_text(encoding="ascii").splitlines() for file in campaign.glob("*.csv")}
    every = max(1, round(sum(map(len, rows.values())) / SAMPLES))
    for test, (header, *lines) in rows.items():
        place = header.split(",").index("ground_acceleration_mps2")
        kept = [line.split(",") for line in [header, *lines[::every]]]
        text = "\n".join(",".join(row[:place] + row[place + 1 :]) for row in kept)
        test.write_text(text + "\n", encoding="ascii")
    file = campaign / "campaign.toml"
    stated = file.read_text(encoding="utf-8")
    rate = re.sub(r"rate_hz = (\S+)", lambda match: f"rate_hz = {float(match[1]) / every!r}", stated)
    file.write_text(rate, encoding="utf-8")


def changes_of(variant: str | None, seed: int, *, hidden: Collection[str]) -> tuple[str, ...]:
    """Names of the changes of a campaign, for the names of what is hidden in it.

    In the mixed variant every third one gets an offset of the force, unless an offset is hidden, whose size
    it would change; where nothing is hidden frequency, damping ratio or mass of the structure are stated
    wrongly in turn.
    """
    if variant != MIXED_VARIANT:
        return () if variant is None else (variant,)
    offset = (FORCE_OFFSET,) if seed % _EVERY_THIRD == 0 and _FORCE_BIAS not in hidden else ()
    wrong = () if hidden else (tuple(WRONG_STRUCTURE)[seed // _EVERY_THIRD % len(WRONG_STRUCTURE)],)
    return offset + wrong


VARIANTS: dict[str, Callable[[Path], None]] = {
    "frequency": _scale_value("frequency_hz", 1.02),
    "damping": _scale_value("damping_ratio", 1.2),
    "mass": _scale_value("mass_kg", 1.02),
    "short": _shorten,
    "two_tests": _keep_two_tests,
    "noisy": lambda _campaign: None,
    FORCE_OFFSET: _add_force_offset,
    "two_blocks": _keep_two_blocks,
}
"""What is changed in the folder of a campaign, by name; noise is drawn by the laboratory itself."""
