"""Studies say what they ask for, and what is wrong with them."""

import pytest

from reliab.errors import InputError
from reliab.study import open_study, read_study, shipped_studies


def test_every_shipped_study_is_valid_and_says_what_it_is_for():
    studies = shipped_studies()
    assert "quick" in studies
    for study in studies.values():
        assert study.title
        assert study.purpose


@pytest.mark.parametrize(
    ("content", "named"),
    [
        ('title = "x"', "kind"),
        ('title = "x"\nkind = "magic"', "criterion"),
        ('title = "x"\nkind = "criterion"\nspeed = 3', "speed is not a known key"),
        ('title = "x"\nkind = "criterion"\n[structures]\nf = [-1.0]', r"structures\.f\.0"),
        ('title = "x"\nkind = "criterion"\n[errors]\nmetrics = ["max"]', "'rms' or 'mte'"),
        (
            'title = "x"\nkind = "criterion"\n[motions]\nsources = ["a"]\nresults = "b"',
            "sources and results exclude each other",
        ),
        ("title = ", "TOML"),
    ],
)
def test_faults_are_named_with_their_key(tmp_path, content, named):
    path = tmp_path / "study.toml"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=named):
        read_study(path)


def test_a_study_that_is_not_there_is_said_to_be_missing(tmp_path):
    with pytest.raises(InputError, match="--list"):
        read_study(tmp_path / "none.toml")
    with pytest.raises(InputError, match="quick"):
        open_study("magic")


def test_other_motions_change_the_digest_and_displace_stored_results():
    study = open_study("quick")
    other = study.on(["elsewhere"], None)
    assert other.motions.sources == ("elsewhere",)
    assert other.motions.results is None
    assert other.digest() != study.digest()
