"""Licences of everything that a user of the package gets with it."""

import re
from importlib.metadata import metadata, requires

import pytest
from packaging.requirements import Requirement

from reliab.study.stages import environment

PERMISSIVE = re.compile(
    r"MIT|BSD|0BSD|Apache|ISC|PSF|Python Software Foundation|Zlib|CC0|HPND|LLVM-exception|Unlicense",
    re.IGNORECASE,
)
COPYLEFT = re.compile(r"GPL|MPL|EUPL|CDDL|EPL|Affero|Reciprocal|Proprietary", re.IGNORECASE)
REASONS: dict[str, str] = {
    "nptdms": "an extra that a user installs to read TDMS; under the LGPL, imported unchanged",
    "obspy": "an extra that a user installs to read miniSEED; under the LGPL, imported unchanged",
}
"""Why a package may be used although its licence is not permissive."""


def packages_of_extra(extra):
    """Packages that an extra of ours brings on this Python."""
    labels = [Requirement(line) for line in requires("reliab") or ()]
    return sorted(
        {item.name.lower() for item in labels if item.marker and item.marker.evaluate({"extra": extra})}
    )


def licence_of(name):
    """What a package states of its licence: an expression, classifiers, or the first line of a text."""
    about = metadata(name)
    classifiers = [line for line in about.get_all("Classifier") or () if line.startswith("License ::")]
    text = (about.get("License") or "").strip()  # type: ignore[attr-defined]
    first = text.splitlines()[0] if text else ""
    return about.get("License-Expression") or "; ".join(classifiers) or first  # type: ignore[attr-defined]


def fault(licence):
    """What is wrong with a licence; each part of an `AND` must be permissive, and one part of an `OR`."""
    if not licence:
        return "unknown"
    choices = re.split(r"\bOR\b", licence)
    parts = [re.split(r"\bAND\b|;", choice) for choice in choices]
    if any(all(PERMISSIVE.search(part) and not COPYLEFT.search(part) for part in choice) for choice in parts):
        return ""
    return "copyleft" if COPYLEFT.search(licence) else "unknown"


@pytest.mark.parametrize(
    "name",
    sorted({*environment()["packages"], *packages_of_extra("recordings"), *packages_of_extra("records")}),
)
def test_every_package_has_a_permissive_licence_or_a_reason(name):
    assert name in REASONS or not fault(licence_of(name)), (
        f"{name}: {licence_of(name)!r} is {fault(licence_of(name))}"
    )


@pytest.mark.parametrize(
    ("licence", "label"),
    [
        ("", "unknown"),
        ("see the file", "unknown"),
        ("GPL-3.0-or-later", "copyleft"),
        ("MIT AND LGPL-2.1-only", "copyleft"),
        ("MPL-2.0 OR MIT", ""),
        ("License :: OSI Approved :: GNU Affero General Public License v3", "copyleft"),
        ("BSD-2-Clause AND Apache-2.0 WITH LLVM-exception", ""),
    ],
)
def test_a_licence_is_judged_by_all_its_parts(licence, label):
    assert fault(licence) == label


def test_a_package_is_listed_once_whatever_its_spelling():
    names = [re.sub(r"[-_.]+", "-", name) for name in environment()["packages"]]
    assert sorted(names) == sorted(set(names))
