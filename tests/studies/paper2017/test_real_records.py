"""What the real records say: the paper's tables, the laws, the closed form, the hierarchical fit."""

import numpy as np
import pytest
from reliab_studies.paper2017.audit import audit
from reliab_studies.validation.law_comparison import compare_laws
from reliab_studies.validation.motion_terms import gain_of_terms

from reliab.core.shipped import shipped
from reliab.criterion.methods.hierarchical.fit import hierarchical_model
from reliab.criterion.population import Population
from reliab.motions.loading import load_motions
from reliab.sampling.ensembles import Ensembles, sample
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.tracking.boundary.first_order import first_order_ellipse

pytestmark = pytest.mark.slow

FREQUENCIES = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
DAMPING_RATIOS = (0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.10)


@pytest.fixture(scope="module")
def suite(real_motions_folder):
    return load_motions(real_motions_folder)


@pytest.fixture(scope="module")
def real_ellipses(suite):
    return trace_ellipses(suite, EllipseRequest(frequencies=FREQUENCIES, damping_ratios=DAMPING_RATIOS))


@pytest.fixture(scope="module")
def audit_table(real_ellipses):
    return audit(shipped("datasets", "paper"), real_ellipses).set_index(["item", "quantity"])


def test_table_3_comes_back_from_the_records(audit_table):
    rows = audit_table.loc["Table 3"]
    ratio = rows["from_records"] / rows["printed"] - 1.0
    assert ratio[ratio.index.str.startswith("a")].abs().max() < 0.35
    assert ratio[ratio.index.str.startswith("b")].abs().max() < 0.20


def test_column_b_of_table_4_is_the_root(audit_table):
    rows = audit_table.loc["Table 4"]
    roots = rows[rows.index.str.startswith("b")]
    np.testing.assert_allclose(roots["from_records"], roots["printed"], rtol=0.16)
    assert (roots["from_records"].iloc[1:] ** 2 > 1.8 * roots["printed"].iloc[1:]).all()


def test_three_quarters_of_table_2_come_back(audit_table):
    back = audit_table.loc["Table 2", "finding"] == "reproduced"
    differences_of_a, differences_of_b = (
        back[back.index.str.startswith(f"{column} of ")].to_numpy() for column in "ab"
    )
    assert differences_of_a.size == differences_of_b.size == 100
    assert (differences_of_a & differences_of_b).sum() >= 70


def test_the_new_law_beats_the_old_ones_at_every_frequency(real_ellipses):
    table = compare_laws(real_ellipses)
    for column in ("log_score", "region_at_f"):
        errors_by_law = table.pivot_table(index="f", columns="law", values=column)
        for old_law in ("exponential", "guo_2017_18"):
            assert (errors_by_law["dimensionless"] > errors_by_law[old_law]).all()


def test_the_closed_form_explains_most_of_the_scatter_between_motions(suite, real_ellipses):
    ellipses_at_two = real_ellipses.sel(xi=[0.02, 0.10])
    records = {motion.name: motion for motion in suite}
    closed_form = np.log(
        [
            [
                [
                    first_order_ellipse(
                        Excitation(
                            acceleration=records[name].acceleration, time_step=records[name].time_step
                        ),
                        Structure(frequency=f, damping_ratio=xi),
                    ).parameters(0.05)
                    for xi in (0.02, 0.10)
                ]
                for f in FREQUENCIES
            ]
            for name in ellipses_at_two["motion"].values.astype(str)
        ]
    )
    for k, (name, least) in enumerate((("a", 0.95), ("b", 0.75))):
        true = np.log(
            ellipses_at_two[name].sel(threshold=0.05, metric="rms", curve="ellipse", side="lag").values
        )
        variance_left = (true - closed_form[..., k]).var(axis=0) / true.var(axis=0)
        assert (1.0 - variance_left).min() > least
    gain = gain_of_terms(ellipses_at_two, {"closed form": closed_form}).loc["closed form"]
    assert gain["gain"] > 2.0


def test_the_hierarchical_fit_converges(real_ellipses):
    posterior = sample(
        hierarchical_model(Population.from_ellipses(real_ellipses, threshold=0.05, metric="rms")),
        Ensembles(steps=800, thin=2),
    )
    table = posterior.table()
    assert posterior.has_converged
    assert table["r_hat"].max() < 1.01
    assert table[["bulk_size", "tail_size"]].min().min() > 1000.0
