"""Sections that say how results were computed and what limits their use."""

from collections.abc import Sequence

from reliab.core.significant_digits import percent
from reliab.core.vocabulary import CurveName
from reliab.criterion.criterion import Criterion
from reliab.report.document import Equation, Paragraph, Points, Section
from reliab.report.prose import Prose, prose
from reliab.report.wording import join_words, meaning_of_confidence, window_in_words
from reliab.validation.yielding import HARDENING, read_yielding

_FITTED_ELLIPSE = (
    "an ellipse is fitted to it by least squares, as a straight line of d² over (A − 1)²; the boundary may "
    "run inside of it"
)
_INSCRIBED_ELLIPSE = "an ellipse is inscribed in it, so that all of the ellipse lies inside the boundary"


def method_section(criterion: Criterion | None, *, experimental_fraction: float, window: str) -> Section:
    """Explain the method of a criterion.

    `experimental_fraction` [-].
    """
    parts = [_simulation(experimental_fraction, window), _indices(), _boundary(criterion)]
    if criterion is not None:
        parts.append(_confidence(criterion))
    return Section(
        title="Method and assumptions",
        blocks=(*parts, _assumptions(experimental_fraction)),
        label="sec:method",
        appendix=True,
    )


def _simulation(experimental_fraction: float, window: str) -> Section:
    return Section(
        title="Simulated tests",
        blocks=(
            Paragraph(
                text=prose(
                    "Each test is that of a structure of natural frequency $f = omega_0 \\/ 2 pi$ and "
                    "damping ratio $xi$ of which the share $alpha = {alpha:g}$ of the stiffness stands in "
                    "the laboratory. Its actuator has the gain $k_p$ and the delay $tau$:",
                    alpha=experimental_fraction,
                )
            ),
            Equation(
                math=(
                    "dot.double(x)_c (t) + 2 xi omega_0 dot(x)_c (t) + (1 - alpha) omega_0^2 x_c (t) "
                    "+ alpha omega_0^2 x_m (t) = -a_g (t), quad quad x_m (t) = k_p x_c (t - tau)"
                ),
                label="eq:loop",
            ),
            Paragraph(
                text=prose(
                    "With $k_p = 1$ and $tau = 0$ the same loop gives the exact response $x_I$. The error "
                    "of the whole test is the deviation of the measured displacement $x_m$ from it, over "
                    "{length}, relative to the peak, not the RMS, of the exact response:",
                    length=window_in_words(window),
                )
            ),
            Equation(
                math=(
                    '"RMS"^R = sqrt(1 / T integral_0^T (x_m - x_I)^2 dif t) / (max abs(x_I)), quad quad '
                    '"MTE"^R = (max abs(x_m - x_I)) / (max abs(x_I))'
                ),
                label="eq:errors",
            ),
        ),
    )


def _indices() -> Section:
    return Section(
        title="Indices of a test",
        blocks=(
            Paragraph(
                text=prose(
                    "After a test, the frequency-domain evaluation index @guo2014 compares the spectra of "
                    "the command $I(t)$ and the measured displacement $O(t)$, weighted with the power of the"
                    " command:"
                )
            ),
            Equation(
                math=(
                    '"FEI" = sum_j w_j F[O]_j / F[I]_j, quad w_j = abs(F[I]_j)^2 / (sum_i abs(F[I]_i)^2), '
                    'quad A = abs("FEI"), quad phi = arg "FEI", quad d = -phi / (2 pi sum_j w_j f_j)'
                ),
                label="eq:index",
            ),
            Paragraph(
                text=prose(
                    "$A$ is the amplitude that reaches the specimen relative to the command, $d$ the "
                    "equivalent delay. For a constant gain and delay they equal $k_p$ and $tau$."
                )
            ),
        ),
    )


def _boundary(criterion: Criterion | None) -> Section:
    return Section(
        title="Boundary of a ground motion",
        blocks=(
            Paragraph(
                text=prose(
                    "For each ground motion the contour of equal error around $A = 1$, $d = 0$ is traced, "
                    "late actuators ($d >= 0$) and early ones separately, and {ellipse}, with $d$ "
                    "in milliseconds:",
                    ellipse=_INSCRIBED_ELLIPSE
                    if criterion is not None and criterion.provenance.curve == CurveName.INSCRIBED
                    else _FITTED_ELLIPSE,
                )
            ),
            Equation(math="(A - 1)^2 / a + d^2 / b = 1", label="eq:ellipse"),
            Paragraph(
                text=prose(
                    "Near resonance the error depends on the complex actuator error over the damping alone, "
                    "so that $a$ grows about as $xi^2$ and $b$ as $(xi \\/ omega_0)^2$."
                )
            ),
        ),
    )


def _confidence(criterion: Criterion) -> Section:
    joint_phrase = "for both together" if criterion.joint else "for each of them separately"
    law = criterion.law
    return Section(
        title="What the confidence means",
        blocks=(
            Paragraph(
                text=prose(
                    "The criterion uses limits of $a$ and $b$ that the stated share of the population's "
                    "ground motions exceeds. Here ({method}, {together}) the confidence is {meaning}. "
                    "Earthquakes, not records, are the independent units of the data.",
                    method=criterion.method,
                    together=joint_phrase,
                    meaning=meaning_of_confidence(criterion.method),
                )
            ),
            Paragraph(
                text=prose(
                    (
                        "Between the structures that were simulated, the limits follow the law “{law}”: "
                        "{equation}."
                    ),
                    law=law.name,
                    equation=law.equation,
                )
            ),
        ),
    )


def _assumptions(experimental_fraction: float) -> Section:
    worst = (
        prose(
            "All stiffness stands in the laboratory ($alpha = 1$). Under 20 real motions, at 0.5 to 3 Hz and "
            "damping ratios of 1 to 10 %, no smaller share was more demanding; for a stiff and damped "
            "structure, of 15 Hz and 5 % for example, it may be."
        )
        if experimental_fraction == 1.0
        else prose(
            "The share of the stiffness in the laboratory is {alpha}; the criterion does not hold for a "
            "larger one.",
            alpha=percent(experimental_fraction),
        )
    )
    return Section(
        title="Assumptions",
        blocks=(
            Points(
                items=(
                    worst,
                    prose("The actuator has a constant gain and a constant delay during the test."),
                    prose(
                        "The ground motion of the test is one of the population that the motions stand for."
                    ),
                    prose(
                        "Errors are relative to the peak of the exact response over the stated stretch of "
                        "time; a "
                        'longer quiet end of a record lowers $"RMS"^R$ without making the test better.'
                    ),
                )
            ),
        ),
    )


def limits_section(sentences: Sequence[Prose]) -> Section:
    """List what limits the use of the results."""
    always = (
        prose(
            "The structure has one degree of freedom and stays linear; other systems are not covered. "
            + _yielding()
        ),
        prose(
            "A criterion looks at $A$ and $d$ alone. An actuator whose gain and delay change during the "
            "test, friction, backlash or noise can cause errors that they do not show."
        ),
    )
    return Section(title="Limits", blocks=(Points(items=(*sentences, *always)),), label="sec:limits")


def _yielding() -> str:
    """Say what was measured on specimens that yield."""
    yielding_rates = read_yielding()
    shares = join_words(
        [
            f"{percent(measurement.exceeding, 2)} of {measurement.tests} tests at $R = "
            f"{measurement.reduction:g}$ (up to "
            f"{measurement.largest_ratio:.1f} times)"
            for measurement in yielding_rates
        ]
    )
    return (
        "A specimen that yields is not always less demanding: with an actuator at which the linear structure "
        f"just reaches the error, the error of an elastoplastic one ({percent(HARDENING)} hardening) is "
        "larger "
        f"in {shares}, $R$ being the peak of the linear response over the yield displacement, under "
        f"{yielding_rates[0].motions} real motions."
    )
