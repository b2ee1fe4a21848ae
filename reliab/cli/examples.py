"""One example for the help of each command."""

from typing import Final

EXAMPLES: Final = {
    "simulate": "reliab simulate --motions synthetic --f 0.5 1 --xi 0.02 --out results.zarr",
    "ellipses": "reliab ellipses --motions records --f 1 --xi 0.02 --out ellipses.nc",
    "criterion": "reliab criterion --ellipses real_suite --f 1 --xi 0.02 --confidence 0.95",
    "assess": "reliab assess sample_test --f 1±0.01 --xi 0.02",
    "compare": "reliab compare none.csv adaptive.csv --f 1 --xi 0.02 --figure ranking.svg",
    "record": "reliab record sample_test --out test.nc",
    "calibrate": "reliab calibrate sine.csv --actuator-delay 0 --out channels.toml",
    "monitor": "reliab monitor sample_test --f 1 --xi 0.02",
    "explore": "reliab explore --out criterion.html",
    "validate": "reliab validate --rebuilt-error --f 1 --xi 0.02 --trials 1",
    "diagnose": "reliab diagnose rig_a --out diagnosis",
    "run": "reliab run --list",
    "report": "reliab report runs/quick",
    "fetch": "reliab fetch datasets/real_suite/results.nc",
    "samples": "reliab samples datasets",
    "info": "reliab info --json -",
}
"""Examples by command."""


def example_of(name: str) -> str:
    """Return the example of a command as the last line of its help."""
    return f"Example: {EXAMPLES[name]}"
