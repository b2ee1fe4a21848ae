"""Commands and their functions give one answer or one refusal, and no option falls between them."""

import inspect
import json
import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

import reliab
from reliab.app import cli
from reliab.app.api import derived_criteria, simulation, sources, studies, validation
from reliab.app.api.criteria import derive_criteria
from reliab.app.api.design import design_test, write_explorer
from reliab.app.api.diagnosis import diagnose_campaign, report_diagnosis
from reliab.app.api.monitor import export_monitor, follow_test
from reliab.app.api.records import calibrate, record
from reliab.app.api.rigs import (
    add_to_rig,
    export_rig,
    list_rig,
    predict_rig,
    remove_from_rig,
    report_rig,
    show_rig_test,
)
from reliab.app.api.simulation import (
    check_motions,
    import_motions,
    list_motions,
    simulate_suite,
    synthesize_motions,
    trace_boundaries,
)
from reliab.app.api.studies import (
    copy_samples,
    describe_installation,
    fetch_dataset,
    list_studies,
    report_run,
    run_study,
)
from reliab.app.api.validation import calibrate_probabilities, validate_criteria
from reliab.app.cli.commands import as_options
from reliab.core.shipped import shipped
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.report.setting import ReportSetting

COMMAND = typer.main.get_group(cli.application())
DRAWS = [20, pytest.param(160, marks=pytest.mark.slow)]
SERVICES: dict[str, Any] = {
    "design": [design_test],
    "simulate": [simulate_suite],
    "ellipses": [trace_boundaries],
    "criterion": [derive_criteria],
    "calibrate": [calibrate],
    "monitor": [follow_test, export_monitor],
    "explore": [write_explorer],
    "record": [record],
    "fetch": [fetch_dataset],
    "samples": [copy_samples],
    "validate": [validate_criteria, calibrate_probabilities],
    "diagnose": [diagnose_campaign, report_diagnosis],
    "run": [run_study, list_studies],
    "report": [report_run],
    "info": [describe_installation],
    "motions list": [list_motions],
    "motions check": [check_motions],
    "motions import": [import_motions],
    "motions synthesize": [synthesize_motions],
    "rig predict": [predict_rig],
    "rig add": [add_to_rig],
    "rig list": [list_rig],
    "rig show": [show_rig_test],
    "rig remove": [remove_from_rig],
    "rig export": [export_rig],
    "rig report": [report_rig],
}
REPORT_OPTIONS = {"title", "date", "paper", "laboratory", "logo"}
CHOOSE_A_SERVICE = {"list_all", "calibration", "rebuilt_error", "check", "figure", "details"}
PLURAL_NAMES = {"sources": "source", "attribute": "attributes"}
PYTHON_ARGUMENTS = {"show", "tell", "say", "addition", "progress"}


def command_of(name):
    command: Any = COMMAND
    for word in name.split():
        command = command.commands[word]
    return command


def test_every_command_but_those_of_a_verdict_is_compared():
    leaves = {
        f"{name} {inner}".strip()
        for name, command in COMMAND.commands.items()
        for inner in getattr(command, "commands", {"": None})
    }
    assert leaves == {*SERVICES, "assess", "compare", "extrapolate", "desk"}


@pytest.mark.parametrize("name", SERVICES)
def test_every_option_is_an_argument_and_every_argument_an_option(name):
    names = {parameter.name for parameter in command_of(name).params} - {"help", "json_target"}
    options = {PLURAL_NAMES.get(option, option) if name == "record" else option for option in names}
    arguments = set().union(*(inspect.signature(service).parameters for service in SERVICES[name]))
    values = arguments - PYTHON_ARGUMENTS - {"setting"}
    assert values <= options
    assert options - values - CHOOSE_A_SERVICE == (REPORT_OPTIONS if "setting" in arguments else set())


NUMBERS = {
    "f": (1.0, 2.0),
    "xi": (0.02, 0.05),
    "threshold": (0.05, 0.1, 0.0, float("nan")),
    "alpha": (1.0, 0.5),
}
SOURCES = {
    "motions": ("records", "synthetic"),
    "results": ("stored.zarr",),
    "ellipses": ("table.csv",),
    "sets": ("near",),
    "metric": ("rms", "mte", "peak"),
    "window": ("record", "2"),
    **NUMBERS,
}
WAYS: dict[str, Any] = {
    "criterion": {
        **SOURCES,
        "confidence": (0.9, 95.0),
        "method": ("quantile", "tolerance", "magic"),
        "assurance": (0.8,),
        "distribution": ("weibull",),
        "law": ("guo_2017_18", "power", "magic"),
        "steps": (40,),
        "chains": ("chains.h5",),
        "model": ("model.toml",),
        "structure": ("frame.toml",),
    },
    "ellipses": {**{key: SOURCES[key] for key in SOURCES if key != "ellipses"}, "model": ("model.toml",)},
    "validate": {
        **SOURCES,
        "scheme": ("k_fold", "magic"),
        "leave_out": ("f", "b"),
        "learn": ("near",),
        "judge": ("far",),
        "law": ("table", "guo_2017_18", "magic"),
        "method": ("quantile", "magic"),
        "confidence": (0.8, 0.95),
        "trials": (16,),
    },
    "simulate": {
        "motions": ("records",),
        "sets": ("near",),
        "f": (1.0, 2.0, 0.0),
        "xi": (0.05, 2.0),
        "grid": ("paper", "coarse"),
        "engine": ("pole", "slow"),
        "alpha": (0.5, 2.0),
        "window": ("record", "never"),
    },
    "explore": {**NUMBERS, "confidence": (0.9, 95.0), "metric": ("rms", "peak")},
    "report": {},
}
ALWAYS = {"simulate": {"out": "out.zarr"}, "explore": {"out": "page.html"}, "report": {"folder": "run"}}
FUNCTIONS = {name: SERVICES[name][0] for name in WAYS}


@pytest.fixture
def stub_services(monkeypatch, tmp_path):
    """What is slow answers with what it was asked."""
    ellipses = read_ellipses(shipped("datasets", "paper/table2.csv"))

    def page(out, windows, settings, source):
        Path(out).write_text(repr((list(windows), settings, source)))

    def asked(*values, **named):
        return SimpleNamespace(asked=repr(values[2:]) + repr(sorted(named.items(), key=str))[:2000])

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sources.EllipseSource, "dataset", lambda *_: ellipses)
    monkeypatch.setattr(derived_criteria, "_describe_kept_share", lambda *_: {})
    monkeypatch.setattr(validation, "true_errors", lambda *_: "truth")
    monkeypatch.setattr(validation, "cross_validate", asked)
    monkeypatch.setattr(validation.Validation, "to_dict", lambda self: {"asked": self.division.name})
    monkeypatch.setattr(simulation, "load_motions", lambda *names, sets: (*names, sets))
    monkeypatch.setattr(simulation, "run_sweep", lambda *_, **__: None)
    monkeypatch.setattr("reliab.explore.page.write_page", page)
    monkeypatch.setattr("reliab.sweep.ellipse_dataset.open_windows", lambda _: {"record": None})
    monkeypatch.setattr(
        studies, "write_report", lambda folder, setting: folder / repr(setting or ReportSetting())
    )


def draw_question(number):
    dice = random.Random(number)  # noqa: S311
    name = dice.choice(list(WAYS))
    terms = {key: dice.choice(values) for key, values in WAYS[name].items() if dice.random() < 0.2}
    return name, {**terms, **ALWAYS.get(name, {})}


def ask_command(capsys, name, stated):
    flags = {key: f"--{key.replace('_', '-')}" for key in stated}
    options = [
        text
        for key, value in stated.items()
        for text in ([str(value)] if key == "folder" else [flags[key], str(value)])
    ]
    code = cli.run([name, *options, "--json", "-"])
    out, err = capsys.readouterr()
    return (code, json.loads(out), "") if code == 0 else (code, None, err.strip())


def ask_python(name, stated):
    try:
        content = FUNCTIONS[name](**stated).to_dict()
    except reliab.InputError as error:
        return 2, None, f"Error: {as_options(str(error), COMMAND)}"
    return 0, json.loads(json.dumps(content)), ""


@pytest.mark.parametrize("draws", DRAWS)
@pytest.mark.usefixtures("stub_services")
def test_drawn_inputs_are_answered_as_one(capsys, draws):
    codes, differences = [], []
    for number in range(draws):
        name, values = draw_question(number)
        if name == "report":
            values = {"folder": Path(values["folder"])}
        response = ask_command(capsys, name, values)
        if response != ask_python(name, values):
            differences.append((name, values, response, ask_python(name, values)))
        codes.append(response[0])
    assert differences == []
    assert codes.count(0) > 0.2 * draws
    assert codes.count(2) > 0.2 * draws
