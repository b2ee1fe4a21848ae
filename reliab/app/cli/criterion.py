"""`reliab criterion`, `design` and `explore`: how much amplitude error and delay a test may have."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Final

from reliab.app import options, questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say, say_population, show_rows, show_table
from reliab.core.columns import Columns
from reliab.core.significant_digits import counted, percent, significant
from reliab.core.vocabulary import ERROR_NAMES, LABELS, MILLI, Metric

if TYPE_CHECKING:
    from reliab.app.api.design import Design
    from reliab.assessment.design import TolerableErrors


@takes(questions.CriterionQuestion, options.LISTING, options.DETAILS)
def criterion(request: Request) -> None:
    """Derive how much amplitude error and delay a test may have.

    Without a source it is derived from real_suite, 100 real ground motions whose ellipses come with reliab.
    """
    if request.list_all:
        request.refuse_all_but({"list_all"}, "together with `list_all`")
        show_choices()
        return
    from reliab.app.api.criteria import derive_criteria

    result = request.answer(
        derive_criteria,
        lambda criteria: show_criteria(criteria.to_dict(), details=request.details),
        "details",
    )
    result.require_converged(request.chains)


_SHOWN_NOTES = 1
_LIMITS = {"delay_limit_ms": "delay", "lead_limit_ms": "lead"}
_DIAGNOSTICS: Columns = {
    "parameter": ("parameter", ""),
    "mean": ("mean", ".3f"),
    "spread": ("spread", ".3f"),
    "R-hat": ("r_hat", ".4f"),
    "bulk size": ("bulk_size", ".0f"),
    "tail size": ("tail_size", ".0f"),
    "autocorrelation time": ("autocorrelation_time", ".1f"),
}


_CURVES = {
    "inscribed": "inscribed in the motions' boundaries",
    "ellipse": "fitted to the motions' boundaries by least squares, as in the paper",
}


def limits_in_words(row: Mapping[str, Any]) -> str:
    """Say what is tolerable at one structure."""
    share = "no stated share" if row["confidence"] is None else percent(row["confidence"])
    subject = "motions, as printed," if "kept_by" in row else "comparable earthquakes"
    if row["amplitude_limit"] == 0.0:
        place = f"At {row['f']:g} Hz, ξ = {row['xi']:g}"
        return f"{place}, no test is accepted: {share} asks too much of these motions."
    limits = [
        f"{percent(row['amplitude_limit'], 2)} amplitude error",
        *(f"{row[key]:.2f} ms {name}" for key, name in _LIMITS.items() if row.get(key) is not None),
    ]
    error = ERROR_NAMES[Metric(row["metric"])] if "metric" in row else "error"
    part = "" if row["alpha"] == 1.0 else f", α = {row['alpha']:g}"
    return (
        f"At {row['f']:g} Hz, ξ = {row['xi']:g}{part}, {share} of {subject} keep the "
        f"{error} below {percent(row['threshold'])} with up to "
        f"{', '.join(limits[:-1])} or {limits[-1]} alone."
    )


def show_criteria(content: Mapping[str, Any], *, details: bool) -> None:
    """Print criteria, with `details` how they were derived, and what else was asked for."""
    from reliab.app.api.derived_criteria import Criteria

    rows = content["criteria"]
    first = rows[0]
    say(limits_in_words(first), style="bold")
    sample = f"{first['n_motions']} {first['motions']} of {first['n_events']} earthquakes"
    show_rows(f"(A − 1)²/a + d²/b ≤ 1 from {sample}", Criteria.table_columns, rows)
    say_population(((row["confidence"], row["population"]) for row in rows), first["position"])
    for posterior in content.get("posteriors", ()):
        _show_posterior(posterior)
    notes = tuple(dict.fromkeys(f"Note: {warning}" for row in rows for warning in row["warnings"]))
    if details:
        joint_phrase = "a and b together" if first["joint"] else "a and b separately"
        say(f"Method: {first['method']}, {joint_phrase}. Law: {first['law']}.")
        say(*_definitions(rows), *notes)
    else:
        shown = len(notes) if any(row["confidence"] is None for row in rows) else _SHOWN_NOTES
        hidden = f"{counted(len(notes) - shown, 'note')}, method" if notes[shown:] else "Method"
        say(*notes[:shown], f"{hidden} and definitions: run with --details.")
        say(f"Next step: judge a test with `reliab assess TEST --f {first['f']:g} --xi {first['xi']:g}`.")
    for name, show in _BESIDE.items():
        if name in content:
            show(content[name])


def _definitions(rows: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """Say what the limits and the error mean."""
    limit_definition = (
        "Each limit alone is that of a test without the other error; a test with both errors "
        "must lie inside the ellipse."
    )
    first = rows[0]
    error = f"Error: {LABELS[first['metric']].long_name}. Window: {first['window']}."
    shares = ", ".join(dict.fromkeys(f"{row['alpha']:g}" for row in rows))
    fraction = f"Share α of the stiffness in the laboratory: {shares}."
    return limit_definition, f"{error} {fraction} Ellipses: {_CURVES[first['curve']]}."


def _show_posterior(posterior: Mapping[str, Any]) -> None:
    show_rows(
        f"Posterior at {posterior['threshold']:g} of {posterior['metric']}: {posterior['ensembles']} "
        f"ensembles of {posterior['walkers']} walkers, {posterior['steps']} steps, "
        f"{percent(posterior['accepted'], decimals=0)} of the moves accepted",
        _DIAGNOSTICS,
        posterior["parameters"],
    )
    if posterior["converged"]:
        say("Converged: R-hat < 1.01 and effective sizes > 1,000 for every parameter.")
        return
    say("THIS POSTERIOR HAS NOT CONVERGED.", style="bold red")
    say(*posterior["complaints"], style="red")


def _show_frame(frame: Mapping[str, Any]) -> None:
    """Print what the limits of a frame are of."""
    erring = frame["erring_actuator"]
    actuators = (
        "all actuators, which err alike"
        if erring == "all alike"
        else f"actuator {erring}; others are perfect"
    )
    say(f"Frame: {frame['name']}. Error of {frame['error_of']}. A and d of {actuators}.")


def _show_coupling(coupling: Mapping[str, Any]) -> None:
    """Print how far actuators may move with each other's commands."""
    rows, share = coupling["limits"], percent(coupling["share_of_motions"], decimals=0)
    cells = [
        (f"actuator {number}", *("-" if value is None else percent(value, decimals=2) for value in row))
        for number, row in enumerate(rows, start=1)
    ]
    show_table(
        "Motion by another actuator's command alone that keeps the error below "
        f"{percent(coupling['threshold'])} under "
        f"{share} of these motions",
        {"": "left", **{f"command {number + 1}": "right" for number in range(len(rows))}},
        cells,
    )


def _show_rig(rig: Mapping[str, Any]) -> None:
    """Print the error of a rig."""
    if not rig["stable"]:
        say("With the described rig, the test of this frame is unstable.", style="yellow")
        return
    rows = {
        "median of the motions": percent(rig["median"], decimals=2),
        "largest": percent(rig["largest"], decimals=2),
        f"motions below {significant(rig['threshold'])}": percent(rig["share_below"], decimals=0),
    }
    for name, form in (("A", ".4f"), ("d_ms", ".3f")):
        values = sorted(motion[name] for motion in rig["motions"])
        rows[f"{name}, least to largest"] = f"{values[0]:{form}} to {values[-1]:{form}}"
    title = f"Error of the described rig, {ERROR_NAMES[Metric(rig['metric'])]}"
    show_table(title, {"": "left", "value": "right"}, rows.items())


def show_choices() -> None:
    """Print what --method, --law and --distribution may be, with what each means."""
    from reliab.criterion.distributions import DISTRIBUTIONS
    from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS
    from reliab.criterion.methods.registry import METHODS

    laws = {**FITTED_LAWS, **MANY_MOTION_LAWS}
    _show_meanings("--method", {name: _describe_method(method) for name, method in METHODS.items()})
    _show_meanings("--law", {name: str(law.equation) for name, law in laws.items()})
    families = {name: (family.__doc__ or "").partition(".")[0] for name, family in DISTRIBUTIONS.items()}
    _show_meanings("--distribution", families)


def _describe_method(method: Any) -> str:  # noqa: ANN401 - a class of the registry
    takes_assurance = any(field.name == "assurance" for field in fields(method))
    return f"{method.meaning}{' (takes --assurance)' if takes_assurance else ''}"


def _show_meanings(option: str, meanings: dict[str, str]) -> None:
    say(f"{option}:", style="bold")
    say(*(f"  {name}: {meaning}" for name, meaning in meanings.items()), soft_wrap=True)


def _show_own_boundary(rows: Sequence[Mapping[str, Any]]) -> None:
    from reliab.app.api.derived_criteria import Criteria

    title = f"Boundary of {rows[0]['motion']} itself: for a test under this very record"
    headings = ("f [Hz]", "ξ [-]", "error [-]", "a [-]", "b [ms²]")
    show_rows(title, {name: Criteria.table_columns[name] for name in headings}, rows)


_BESIDE: Final[dict[str, Callable[[Any], None]]] = {
    "frame": _show_frame,
    "own_boundary": _show_own_boundary,
    "cross_coupling": _show_coupling,
    "rig": _show_rig,
}


@takes(questions.DesignQuestion, options.CHART, options.DETAILS)
def design(request: Request) -> None:
    """Print how much amplitude error and delay are tolerable, before a test."""
    from reliab.app.api.assessment import draw_chart
    from reliab.app.api.design import design_test

    result = request.answer(
        design_test,
        lambda design: show_design(design, details=request.details, chosen=request.confidence is not None),
        "figure",
        "details",
    )
    if request.figure is not None:
        draw_chart(result, request.figure)


_NINETY_FIVE = 0.95
_BAR = 40


def show_design(design: "Design", *, details: bool, chosen: bool = False) -> None:
    """Print tolerable errors at 95 % or the `chosen` confidences; with `details` all of them, and a chart."""
    from reliab.app.api.design import Design

    rows = design.tolerances if details or chosen else _at_ninety_five(design.tolerances)
    first = rows[0]
    say(limits_in_words(first.to_dict()), style="bold")
    share = "" if first.experimental_fraction == 1.0 else f" and α = {first.experimental_fraction:g}"
    title = f"Tolerable errors at ξ = {first.damping_ratio:g}{share}, error {percent(first.threshold)}"
    show_rows(title if details else "", Design.table_columns, (row.to_dict() for row in rows))
    say_population(((row.promise, row.population) for row in rows), first.position)
    if any(tolerance.outside_validity for tolerance in rows):
        say("Note: the criterion does not cover *; these limits are scaled from the nearest structure.")
    if details:
        _show_chart(design.chart)
    else:
        say("Other confidences and frequencies: run with --details.")
    structure = f"--f {first.frequency:g} --xi {first.damping_ratio:g}"
    say(f"Next step: judge a test with `reliab assess TEST {structure}`, of a frame with --structure FRAME.")


def _at_ninety_five(tolerances: "Sequence[TolerableErrors]") -> "list[TolerableErrors]":
    """Select the confidence nearest to 95 %."""
    confidence = min((one.confidence for one in tolerances), key=lambda value: abs(value - _NINETY_FIVE))
    return [one for one in tolerances if one.confidence == confidence]


def _show_chart(chart: "Sequence[TolerableErrors]") -> None:
    """Bars of the tolerable delay over the frequency at one confidence, the longest being the widest."""
    from reliab.app.api.design import Design

    points = _at_ninety_five(chart)
    promise, longest = points[0].promise, max(MILLI * point.delay for point in points)
    share = "no share promised" if promise is None else f"at {percent(promise, decimals=0)}"
    columns = {name: Design.table_columns[name] for name in ("f [Hz]", "|A − 1| alone", "d alone [ms]")} | {
        "d": ("delay_limit_ms", lambda late: "█" * max(round(_BAR * late / longest), 1), "left")
    }
    show_rows(f"Over the frequency, {share}", columns, (point.to_dict() for point in points))


_MEGABYTE = 1e6


@takes(questions.ExplorerQuestion)
def explore(request: Request) -> None:
    """Write an offline web page with sliders that show tolerable errors before a test."""
    from reliab.app.api.design import ExplorerPage, write_explorer

    def show(result: ExplorerPage) -> None:
        say(f"{result.page}: {result.size / _MEGABYTE:.1f} MB, open it in any browser.")

    request.answer(write_explorer, show)
