"""Former names do what they did, with a warning, for one further minor version."""

import pytest

import reliab
from reliab import discrepancy
from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.core.shipped import shipped
from reliab.core.stated_value import StatedValue
from reliab.recordings.reading import read_recording
from reliab.renamed import renamed_method

STRUCTURE = reliab.Structure(frequency=1.0, damping_ratio=0.02)


def answer(assessment):
    """All that is found, without the quantities that are stated by default."""
    return {**assessment.to_dict(), "stated": None}


@pytest.mark.slow
@pytest.mark.parametrize(
    "former",
    [
        {"taper": "boxcar"},
        pytest.param({"seed": 5}, marks=pytest.mark.slow),
        pytest.param({"stated": {"f": StatedValue(1.0, 0.05)}}, marks=pytest.mark.slow),
    ],
)
def test_former_arguments_of_assess_do_what_they_did(former):
    (name,) = former
    with pytest.warns(DeprecationWarning, match=f"`{name}`.*0.4.*reliab.assessment.assess") as warned:
        by_name = reliab.assess("sample_test", STRUCTURE, **former)
    assert warned[0].filename == __file__
    recording = read_recording(shipped("datasets", "sample_test/test.csv"))
    usual = {"equipment": ordinary_equipment(), "stated": recording.stated}
    given = {**former, "stated": {**recording.stated, **former.get("stated", {})}}
    expected = assess(recording, STRUCTURE, **{**usual, **given})
    without = assess(recording, STRUCTURE, **usual)
    assert answer(by_name) == answer(expected) != answer(without)


def test_former_arguments_have_no_meaning_for_frames():
    frame = next(shipped("datasets", "frames").rglob("*.toml"))
    with (
        pytest.warns(DeprecationWarning, match="`seed`"),
        pytest.raises(reliab.InputError, match="frame"),
    ):
        reliab.assess("sample_test", frame, seed=3)


def test_results_of_a_diagnosis_still_have_their_former_method():
    results = [getattr(discrepancy, name) for name in discrepancy.__all__]  # type: ignore[attr-defined]
    owners = [owner for owner in results if hasattr(owner, "to_dict")]
    assert len(owners) >= 5
    assert all(hasattr(owner, "as_dict") for owner in owners)


def test_a_former_method_is_the_new_one_with_a_warning():
    @renamed_method("0.4", "as_dict", "to_dict")
    class Result:
        def to_dict(self):
            return {"a": 1}

    with pytest.warns(DeprecationWarning, match="`as_dict` is called `to_dict` now.*0.4") as warned:
        assert Result().as_dict() == {"a": 1}  # type: ignore[attr-defined]
    assert warned[0].filename == __file__
