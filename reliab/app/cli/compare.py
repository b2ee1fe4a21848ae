"""`reliab compare`: tests ranked by their errors, such as one with each compensator."""

from dataclasses import replace
from typing import Any

from reliab.app import options, questions
from reliab.app.cli.commands import Request, files_of, takes
from reliab.app.cli.output import console, progress_bar, say, write_json
from reliab.core.significant_digits import counted


@takes(questions.AssessmentQuestion, options.Tests, options.Chart, options.Details)
def compare(request: Request) -> None:
    """Rank tests by error and say how certain the ranking is.

    The tests are of one structure and rig, such as one motion with each compensator.
    """
    from reliab.app.api.assessment import assess, compare_assessments
    from reliab.app.api.assessment_files import draw_chart, write_tests
    from reliab.report.kinds.comparison import comparison_report, next_step
    from reliab.report.prose import words_of
    from reliab.report.terminal import print_blocks

    files = files_of(request.tests, request.out)
    with progress_bar("tests") as progress:
        verdicts: Any = request.ask(
            assess,
            *("tests", "out", "figure", "details"),
            test=files[0] if len(files) == 1 and request.test_name == "all" else files,
            progress=progress,
        )
    comparison = compare_assessments(verdicts)
    if request.out is not None:
        write_tests(comparison, request.out)
    content = comparison.to_dict()
    content["faults"] = {file: request.write_as_options(fault) for file, fault in content["faults"].items()}
    if not write_json(content, request.json_target):
        document = comparison_report(replace(comparison, faults=content["faults"]), has_figure=False)
        say(words_of(document.verdict), style="bold")
        table, limits = document.blocks
        print_blocks((table, limits) if request.details else (table,), console())
        if not request.details:
            say(*(f"{file}: {fault}" for file, fault in content["faults"].items()))
            say(f"{counted(len(comparison.notes) + 1, 'note')} on the ranking: run with --details.")
        say(f"Next step: {next_step(comparison)}")
    if request.figure is not None:
        draw_chart(comparison, request.figure)
