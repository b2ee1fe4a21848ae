"""The paper's cases with other integrators and compensators than the paper's."""

from dataclasses import replace

import pytest
from reliab_studies.paper2017.cases import COMPENSATORS, INTEGRATORS, list_printed_cases, run_paper_cases

from reliab.core.errors import InputError
from reliab.motions.synthetic.suite import synthetic_suite


@pytest.fixture(scope="module")
def outcome():
    motion, case = synthetic_suite(count=1)[0], list_printed_cases()[0]
    motion = replace(motion, acceleration=motion.acceleration[: round(12.0 / motion.time_step) + 1])
    return lambda **names: run_paper_cases(motion, [case], **names)[0]


def test_every_choice_changes_the_errors(outcome):
    errors = {name: outcome(integrator=name).rms for name in INTEGRATORS}
    assert len(set(errors.values())) == len(INTEGRATORS)
    assert max(errors.values()) / min(errors.values()) < 1.01  # 1024 Hz is fine enough for all of them
    delays = {name: outcome(compensator=name).equivalent_delay for name in COMPENSATORS}
    assert len({round(delay, 7) for delay in delays.values()}) >= 3
    assert delays["none"] == pytest.approx(3.0 / 1024.0, rel=0.1)  # the record ends before the response
    assert all(abs(delays[name]) < 0.4 * delays["none"] for name in COMPENSATORS if name != "none")


def test_unknown_names_are_refused(outcome):
    with pytest.raises(InputError, match="chen_ricles"):
        outcome(integrator="magic")
    with pytest.raises(InputError, match="feedforward"):
        outcome(compensator="magic")
