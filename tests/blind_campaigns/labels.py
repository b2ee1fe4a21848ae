"""What is hidden in a campaign, for the scoring only: never written into the campaign's folder."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

SCHEMA = 1


@dataclass(frozen=True, kw_only=True)
class Label:
    """The sealed truth of a campaign; README.md describes every entry."""

    campaign: str
    seed: int
    kind: str
    verdict: str
    observation: str
    effects: list[dict[str, Any]]
    calibration: dict[str, Any]
    structure: dict[str, Any] | None
    specimen: dict[str, Any] | None
    noise: dict[str, Any]
    tests: list[dict[str, Any]]
    rate_hz: float
    schema: int = SCHEMA

    @property
    def names(self) -> set[str]:
        """Names of the hidden effects."""
        return {effect["name"] for effect in self.effects}


def write_label(label: Label, folder: Path) -> Path:
    """Write a label as `<campaign>.json` into a folder of its own."""
    path = folder / f"{label.campaign}.json"
    path.write_text(json.dumps(asdict(label), indent=1) + "\n", encoding="utf-8")
    return path


def read_labels(folder: Path) -> dict[str, Label]:
    """Return all labels of a folder by campaign name."""
    labels = [Label(**json.loads(path.read_text(encoding="utf-8"))) for path in sorted(folder.glob("*.json"))]
    return {label.campaign: label for label in labels}
