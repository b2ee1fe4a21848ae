"""What the package offers to Python mirrors the command line."""

import subprocess
import sys

import pytest

import reliab

PROMISED = (
    *("load_motions", "simulate", "ellipses", "derive_criterion"),
    *("assess", "cross_validate", "diagnose", "write_report"),
)


@pytest.mark.parametrize("name", [name for name in reliab.__all__ if name != "__version__"])
def test_every_name_is_a_documented_function(name):
    offered = getattr(reliab, name)
    assert callable(offered)
    assert offered.__doc__
    assert name in dir(reliab)


def test_the_names_of_the_design_are_there():
    assert set(PROMISED) <= set(reliab.__all__)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="magic"):
        reliab.magic  # noqa: B018


def test_importing_the_package_imports_no_numerics():
    code = "import sys, reliab; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603
    assert done.stdout.strip() == "False"


def test_a_test_is_judged_from_a_name_and_numbers():
    by_numbers = reliab.assess("sample_test", f="1±0.01", xi=0.02)
    by_structure = reliab.assess(
        by_numbers.recording,
        reliab.Structure(frequency=1.0, damping_ratio=0.02),
        stated=by_numbers.stated,
    )
    assert by_numbers.stated["f"].deviation == 0.01
    assert by_numbers.to_dict() == by_structure.to_dict()


@pytest.mark.parametrize(
    "given",
    [{}, {"f": 1.0}, {"f": "one", "xi": 0.02}, {"f": 1.0, "xi": 0.02, "criterion": "missing.json"}],
)
def test_a_structure_that_is_not_stated_is_refused(given):
    with pytest.raises(reliab.InputError):
        reliab.assess("sample_test", **given)


def test_a_structure_that_is_stated_twice_is_refused():
    structure = reliab.Structure(frequency=1.0, damping_ratio=0.02)
    with pytest.raises(reliab.InputError, match="once"):
        reliab.assess("sample_test", structure, f=1.0)
