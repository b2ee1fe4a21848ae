"""Whole answers stay as they are: whatever changes in them was asked for.

An answer that shall change is kept anew with `python tests/unchanged/renew.py NAME...`; what differs is then
read in the commit, number by number. Other libraries draw, optimise and set tables in other ways, so that
answers are compared with the versions with which all were kept.
"""

import json
from pathlib import Path

import pytest
from unchanged.asking import QUESTIONS, answers, versions
from unchanged.comparing import differences
from unchanged.laboratory import write_laboratory

KEPT = Path(__file__).with_name("kept")


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory):
    if versions() != json.loads((KEPT.parent / "versions.json").read_text(encoding="utf-8")):
        pytest.skip(f"answers were kept with other versions of libraries than {versions()}")
    folder = tmp_path_factory.mktemp("laboratory").resolve()
    write_laboratory(folder)
    return folder


@pytest.mark.default_cases(12)
@pytest.mark.parametrize("name", QUESTIONS)
def test_an_answer_is_the_one_that_is_kept(name, laboratory):
    kept = json.loads((KEPT / f"{name}.json").read_text(encoding="utf-8"))
    found = json.loads(json.dumps(answers(QUESTIONS[name]["question"], laboratory)))
    assert not list(differences(found, kept, QUESTIONS[name]["tolerance"]))


def test_every_kept_answer_is_asked():
    assert {path.stem for path in KEPT.iterdir()} == set(QUESTIONS)


@pytest.mark.parametrize(
    ("found", "kept"),
    [
        ({"a": 1.0}, {"a": 1.001}),
        ({"a": 1.0}, {}),
        ([1.0], [1.0, 2.0]),
        ("0.5 mm", "0.5 m"),
        ("0.52 mm", "0.50 mm"),
        (True, 1),
        (None, 0.0),
        ("1", 1),
    ],
)
def test_a_difference_is_seen(found, kept):
    assert list(differences(found, kept, 1e-6))
    assert not list(differences(found, found, 1e-6))


def test_the_last_digit_of_a_text_may_differ():
    assert not list(differences("0.51 mm of 3.0", "0.50 mm of 3.0", 1e-6))
