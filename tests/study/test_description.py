"""Studies say what they ask for, and what is wrong with them."""

from typing import Any

import pytest

from reliab.core.errors import InputError
from reliab.study.description import folders_of_studies
from reliab.study.running import open_study, read_study


@pytest.mark.of_studies
def test_every_shipped_study_is_valid_and_states_its_purpose():
    assert "quick" in folders_of_studies()
    for study in map(open_study, folders_of_studies()):
        assert study.title
        assert study.purpose


@pytest.mark.parametrize(
    ("content", "labels"),
    [
        ('title = "x"', "kind"),
        ('title = "x"\nkind = "criterion"\n[structures]\nf = []', r"structures\.f: at least one value"),
        (
            'title = "x"\nkind = "criterion"\n[structures]\nf = [1.0, 1.0]',
            r"structures\.f: each value is given",
        ),
        ('title = "x"\nkind = "criterion"\n[motions]\nsources = []', r"motions\.sources: at least one"),
        (
            'title = "x"\nkind = "criterion"\n[errors]\nwindow = "soon"',
            r"errors\.window: .*number of seconds",
        ),
        ('title = "x"\nkind = "criterion"\n[criterion]\nmethod = "magic"', r"criterion\.method: .*dirichlet"),
        ('title = "x"\nkind = "criterion"\n[criterion]\nlaw = "magic"', r"criterion\.law: .*dimensionless"),
        (
            'title = "x"\nkind = "criterion"\n[validation]\nheld_out = "K"',
            r"validation\.held_out is not a known key",
        ),
        ('title = "x"\nkind = "criterion"\n[campaign]\nfolder = "rig_a"', "campaign is not a known table"),
        ('title = "x"\nkind = "discrepancy"', "campaign is missing"),
        (
            'title = "x"\nkind = "discrepancy"\n[campaign]\nfolder = "a"\n[motions]\n[criterion]\n',
            "motions is not a known table; criterion is not a known table",
        ),
        pytest.param(
            'title = "x"\nkind = "table_audit"\n[motions]\nresults = "real_suite"',
            r"motions\.results is not a known key",
            marks=pytest.mark.of_studies,
        ),
        pytest.param(
            'title = "x"\nkind = "suites"\n[validation]\nschemes = ["k_fold"]',
            r"validation\.schemes is not",
            marks=pytest.mark.of_studies,
        ),
        ('title = "x"\nkind = "magic"', "criterion"),
        ('title = "x"\nkind = "criterion"\nspeed = 3', "speed is not a known key"),
        ('title = "x"\nkind = "criterion"\n[structures]\nf = [-1.0]', r"structures\.f\.0"),
        ('title = "x"\nkind = "criterion"\n[errors]\nmetrics = ["max"]', "'rms' or 'mte'"),
        (
            'title = "x"\nkind = "criterion"\n[motions]\nsources = ["a"]\nresults = "b"',
            "results cannot be combined with sources or sets",
        ),
        ("title = ", "TOML"),
    ],
)
def test_faults_are_named_with_their_key(tmp_path, content, labels):
    path = tmp_path / "study.toml"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=labels):
        read_study(path)


@pytest.mark.of_studies
def test_missing_study_is_reported(tmp_path):
    with pytest.raises(InputError, match="--list"):
        read_study(tmp_path / "none.toml")
    with pytest.raises(InputError, match="quick"):
        open_study("magic")


@pytest.mark.of_studies
def test_other_motions_change_the_digest_and_displace_stored_results():
    study = open_study("quick")
    second: Any = study.replace_motions(["elsewhere"], None)
    assert second.motions.sources == ("elsewhere",)
    assert second.motions.results is None
    assert second.digest() != study.digest()


@pytest.mark.of_studies
def test_a_study_of_no_ground_motions_takes_none():
    for name in ("hidden_effect", "blind_evaluation"):
        with pytest.raises(InputError, match="take no ground motions"):
            open_study(name).replace_motions(["elsewhere"], None)
    with pytest.raises(InputError, match="sets"):
        open_study("quick").replace_motions(None, ["far_field"])


@pytest.mark.of_studies
def test_a_question_is_not_followed_by_a_colon():
    titles = {name: open_study(name).full_title("real motions") for name in ("quick", "validation")}
    assert titles["quick"] == "Limits of amplitude error and delay: real motions"
    assert titles["validation"] == "Do criteria keep their promise? Real motions"
