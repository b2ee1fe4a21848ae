"""One campaign's label beside what the product said of it (`reliab diagnose --json`, CAMPAIGN.md)."""

import json
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from blind_campaigns.case import ONE_CHANNEL, Observation
from blind_campaigns.labels import Label

CALIBRATION_NAMES = {"gain_error", "delay_error"}
"""Names in a result that are calibration and not missing effects."""

WRONG_STRUCTURE = {
    "frequency": "structure_frequency",
    "damping": "structure_damping",
    "mass": "structure_mass",
}
"""Variants in which the structure is stated wrongly, and the calibrated value that tells it."""

_NEARLY_ALL = 0.9

Names = dict[str, dict[str, Any]]
"""By effect and parameter of the label: the product's parameter, `{name, factor}` (label × factor), or
false to skip.
"""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """A label and its result; `result` is None where the product gave none."""

    label: Label
    result: dict[str, Any] | None

    @property
    def verdict(self) -> str:
        """The product's verdict, `no_result` where it gave none."""
        return "no_result" if self.result is None else str(self.result.get("verdict", "no_result"))

    @property
    def named(self) -> set[str]:
        """Effects that the product names as missing, whatever their probability."""
        if self.result is None:
            return set()
        names = {str(effect["name"]) for effect in self.result.get("effects", [])}
        return names - self._apart if self.verdict == "named" else set()

    @property
    def _apart(self) -> set[str]:
        """Names that count neither way: calibration, and an offset that a variant added, rightly named."""
        offset = {"force_bias"} - self.label.names if "force_offset" in self.changed else set()
        return CALIBRATION_NAMES | offset

    @property
    def changed(self) -> set[str]:
        """Names of the variants by which the campaign was changed after it was drawn."""
        return set((self.result or {}).get("changed", []))

    @property
    def wrongly_stated(self) -> set[str]:
        """Calibrated values that tell what a variant stated wrongly, as far as the channels show it.

        Where nearly all of the stiffness is the specimen's, and in one channel, a frequency shows as its
        stiffness, and a mass in one channel, or one that is not stated, not at all.
        """
        wrong = {WRONG_STRUCTURE[name] for name in self.changed & set(WRONG_STRUCTURE)}
        one_channel = self.label.observation in ONE_CHANNEL
        if not one_channel and self.label.observation != Observation.FULL:
            return set()
        structure = self.label.structure or {}
        if one_channel or structure.get("experimental_fraction", 0.0) > _NEARLY_ALL:
            wrong = {"stiffness" if value == "structure_frequency" else value for value in wrong}
        unseen = one_channel or structure.get("mass_kg", 1.0) is None
        return wrong - {"structure_mass"} if unseen else wrong

    @property
    def told(self) -> bool:
        """Whether all that was stated wrongly is told, or said to be one of two that no data tell apart."""
        doubted = self._mentioned() if self.verdict == "not_identifiable" else set()
        doubted |= set((self.result or {}).get("either_misstated", []))
        return self.wrongly_stated <= self.misstated | doubted

    @property
    def misstated(self) -> set[str]:
        """Calibrated values that contradict what was stated."""
        return set((self.result or {}).get("misstated", []))

    @property
    def exact(self) -> bool:
        """Whether exactly the hidden effects are named."""
        return self.verdict == "named" and self.named == self.label.names

    @property
    def wrong(self) -> bool:
        """Whether a name is given that is not hidden."""
        return bool(self.named - self.label.names)

    @property
    def honest(self) -> bool:
        """Whether the answer is exact, or differs only by effects that nobody could tell apart.

        `not_identifiable` is honest where the label says that the effect has a twin, and lists both.
        """
        if self.exact:
            return True
        allowed = {twin for effect in self.label.effects for twin in effect["degenerate_with"]}
        if not allowed or self.result is None:
            return False
        if self.verdict == "not_identifiable":
            return bool(self._mentioned() & self.label.names) and bool(self._mentioned() & allowed)
        missed, false = self.label.names - self.named, self.named - self.label.names
        return self.verdict == "named" and len(missed) == len(false) and false <= allowed

    @property
    def flagged(self) -> bool:
        """Whether the product says that it does not know the effect, with an expression or a place."""
        if self.exact:  # a member of the product's library by the same name
            return True
        if self.result is None or self.verdict != "unknown_effect":
            return False
        unknown = self.result.get("unknown") or {}
        return bool(unknown.get("expression") or unknown.get("description") or self.result.get("where"))

    @property
    def closed_fraction(self) -> float | None:
        """Share of the gap that the product closed on held-out tests."""
        gap = (self.result or {}).get("gap") or {}
        value = gap.get("closed_fraction")
        return None if value is None else float(value)

    @property
    def stated(self) -> list[tuple[float, bool]]:
        """Each stated probability of a named effect, and whether the effect is hidden."""
        effects = (self.result or {}).get("effects", []) if self.verdict == "named" else []
        chosen = [effect for effect in effects if effect["name"] not in self._apart]
        return [
            (float(e["probability"]), e["name"] in self.label.names)
            for e in chosen
            if e.get("probability") is not None
        ]

    def _mentioned(self) -> set[str]:
        effects = (self.result or {}).get("effects", [])
        rivals = {str(rival["name"]) for effect in effects for rival in effect.get("rivals", [])}
        return rivals | {str(effect["name"]) for effect in effects}

    def intervals(self, names: Names) -> list[tuple[str, bool]]:
        """Return the parameters of a rightly named effect, and whether value ± 1.645 sd covers the truth."""
        if not self.exact:
            return []
        results = {effect["name"]: effect.get("parameters", {}) for effect in self.result["effects"]}
        found = []
        for effect in self.label.effects:
            for parameter, entry in effect["parameters"].items():
                theirs, factor = _translated(names, effect["name"], parameter)
                estimate = results[effect["name"]].get(theirs) if theirs else None
                if estimate is not None and estimate.get("sd"):
                    error = abs(float(estimate["value"]) - factor * entry["value"])
                    found.append((f"{effect['name']}.{parameter}", error <= 1.645 * float(estimate["sd"])))
        return found


def _translated(names: Names, effect: str, parameter: str) -> tuple[str | None, float]:
    """Return the product's name of a parameter and the factor from the label's value to the product's."""
    entry = names.get(effect, {}).get(parameter, parameter)
    if entry is False:
        return None, 1.0
    if isinstance(entry, dict):
        return str(entry.get("name", parameter)), float(entry.get("factor", 1.0))
    return str(entry), 1.0


def read_outcomes(labels: dict[str, Label], results: Path) -> list[Outcome]:
    """Return an outcome per label; results are `<campaign>.json` in a folder, missing ones stay None."""
    outcomes = []
    for name, label in labels.items():
        path = results / f"{name}.json"
        result = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
        outcomes.append(Outcome(label=label, result=result))
    return outcomes


def read_names(path: Path) -> Names:
    """Return the translation of parameter names."""
    return tomllib.loads(path.read_text(encoding="utf-8"))
