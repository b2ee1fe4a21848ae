"""A report that somebody sent is data: nothing in it is executed, and no file of this machine is read."""

import datetime as dt
import json

import pytest
from matplotlib.figure import Figure as Drawing

from reliab.app.cli import run
from reliab.core.errors import InputError
from reliab.report.content import files_of, read_content, save_content
from reliab.report.document import Document, Equation, Figure
from reliab.report.pdf import compile_report, templates
from reliab.report.prose import Math, prose, require_formula
from reliab.report.setting import ReportSetting

DATE = dt.date(2026, 1, 1)
STUDY = {"title": "Sent", "kind": "discrepancy", "date": "2026-01-01", "campaign": {"folder": "elsewhere"}}
READING = (
    '#read("secret.txt")',
    'std.read("secret.txt")',
    'a #std.read("secret.txt")',
    'x "a" std.read("secret.txt") "b"',
    '"\\"" std.read("secret.txt") "\\""',
    'std . read("secret.txt")',
    "eval(x)",
    'image("secret.svg")',
    '#import "@preview/cetz:0.3.0"',
    "$ #panic() $",
    "x2",
)
"""Formulas that read files, or would if words were let through."""

SVG = 'svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"'
LINKED = f'<{SVG}><image href="{{}}" width="9" height="9"/></svg>'
ENTITY = f'<!DOCTYPE svg [<!ENTITY x SYSTEM "secret.txt">]><{SVG}><text>&x;</text></svg>'


@pytest.fixture
def sent(tmp_path, monkeypatch):
    """Run folder with a report, beside a file that nobody may read; the working folder holds both."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "secret.txt").write_text("secret")
    drawing = Drawing(figsize=(2, 1))
    drawing.subplots().plot([1.0, 2.0])
    drawing.savefig(tmp_path / "secret.png")
    blocks = (
        prose("Where $xi = {xi:g}$.", xi=0.02),
        Equation(math="a + b", label="eq:one"),
        Figure(drawing=drawing, caption="A line.", label="fig:one"),
    )
    report = Document(kind="Test", title="Sent", verdict="Good.", blocks=blocks)
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "manifest.json").write_text(json.dumps({"study": STUDY, "stages": {}}))
    save_content(report, folder / "report")
    return folder


def test_saving_again_replaces_the_first_content(tmp_path, monkeypatch):
    """One report is being written while another is saved to the same place."""
    first, second = (Document(kind="Test", title=title, verdict="Good.", blocks=()) for title in ("A", "B"))
    place = tmp_path / "report"
    save_content(first, place)
    assert b'"A"' in read_content(place)["document.json"]

    def interrupted(document):
        monkeypatch.setattr("reliab.report.content.files_of", files_of)
        save_content(second, place)
        assert b'"B"' in read_content(place)["document.json"]
        return files_of(document)

    monkeypatch.setattr("reliab.report.content.files_of", interrupted)
    save_content(first, place)
    assert b'"A"' in read_content(place)["document.json"]
    assert [path.name for path in tmp_path.iterdir()] == ["report"]


def change_content(folder, change):
    path = folder / "report" / "document.json"
    content = json.loads(path.read_text())
    change(content["blocks"])
    path.write_text(json.dumps(content))


def refuse_folder(folder, capsys):
    """Message with which a folder is refused; nothing was written."""
    assert run(["report", str(folder)]) == 2
    assert not (folder / "report.pdf").exists()
    message = capsys.readouterr().err
    assert "Traceback" not in message
    return message


def test_saved_content_is_set_like_the_document(sent):
    assert run(["report", str(sent)]) == 0
    content = read_content(sent / "report")
    assert (sent / "report.pdf").read_bytes() == compile_report(content, date=DATE)
    assert set(content) == {"document.json", "figure-1.svg"}


@pytest.mark.parametrize("name", [*templates(), "logo.png", "figure-2.svg"])
def test_unnamed_files_are_not_used(sent, name):
    reference = compile_report(read_content(sent / "report"), date=DATE)
    (sent / "report" / name).write_text('#read("secret.txt")')
    assert run(["report", str(sent)]) == 0
    assert (sent / "report.pdf").read_bytes() == reference


@pytest.mark.parametrize("name", templates())
def test_templates_are_those_of_the_package_whatever_the_content_is(sent, name):
    content = read_content(sent / "report")
    hostile = {**content, name: b'#read("secret.txt")'}
    assert compile_report(hostile, date=DATE) == compile_report(content, date=DATE)


@pytest.mark.default_cases(8)
@pytest.mark.parametrize("formula", READING)
@pytest.mark.parametrize("place", ["line", "equation", "unused"])
def test_an_invalid_formula_is_refused(sent, capsys, formula, place):
    def change(blocks):
        if place == "line":
            blocks[0]["text"][1]["source"] = formula
        elif place == "equation":
            blocks[1]["math"] = formula
        else:
            blocks[0]["anything"] = {"kind": "math", "source": formula}

    change_content(sent, change)
    assert "A formula is built of" in refuse_folder(sent, capsys)


def test_a_formula_hidden_behind_a_repeated_key_is_not_set(sent):
    path = sent / "report" / "document.json"
    twice = '"source": "std.read(\\"secret.txt\\")", "source": "x"'
    path.write_text(path.read_text().replace('"source": "xi = 0.02"', twice))
    assert twice in path.read_text()
    assert b"std.read" not in read_content(sent / "report")["document.json"]


@pytest.mark.parametrize("formula", READING)
def test_authors_of_reports_are_held_to_the_same_formulas(formula):
    for make in (require_formula, lambda text: Math(source=text), lambda text: Equation(math=text)):
        with pytest.raises(ValueError, match="A formula is built of"):
            make(formula)


@pytest.mark.default_cases(4)
@pytest.mark.parametrize(
    "name",
    [
        *("../../secret.png", "/etc/hostname", "document.json", "main.typ", "figure-1.png", "figure-1.svg\n"),
        *("figure-7.svg", "", "figure-1.svg\0", None, 1, ["figure-1.svg"]),
    ],
)
def test_a_figure_of_another_name_is_refused(sent, capsys, name):
    change_content(sent, lambda blocks: blocks[2].update(file=name))
    rule = "figure-7.svg: No such file" if name == "figure-7.svg" else "A report is set from its content"
    assert rule in refuse_folder(sent, capsys)


@pytest.mark.parametrize(
    "picture",
    [
        *(
            LINKED.format(place)
            for place in ("secret.png", "../secret.png", "/etc/x.png", "http://localhost/x")
        ),
        *(LINKED.format(place) for place in ("file:///etc/x.png", "main.typ")),
        ENTITY,
        '#read("secret.txt")',
        "",
    ],
)
def test_a_figure_naming_another_file_is_refused(sent, capsys, picture):
    (sent / "report" / "figure-1.svg").write_text(picture)
    assert "A report is set from its content" in refuse_folder(sent, capsys)


def test_a_picture_beside_the_working_folder_cannot_be_part_of_a_logo(sent, tmp_path):
    logo = tmp_path / "logo.svg"
    logo.write_text(LINKED.format("secret.png"))
    with pytest.raises(InputError, match="A logo must be a sound picture"):
        compile_report(read_content(sent / "report"), date=DATE, setting=ReportSetting(logo=logo))


@pytest.mark.parametrize("part", ["report/figure-1.svg", "report/document.json", "report", "manifest.json"])
def test_a_link_in_the_folder_is_refused(sent, capsys, part):
    part_file = sent / part
    elsewhere = part_file.rename(sent.parent / "moved")
    part_file.symlink_to(elsewhere)
    assert "must not contain links" in refuse_folder(sent, capsys)


@pytest.mark.parametrize("content", ["", "[]", "1", "null", "{}", "[" * 100_000, '{"blocks": NaN}', "\ud800"])
def test_invalid_content_is_refused(sent, capsys, content):
    (sent / "report" / "document.json").write_bytes(content.encode(errors="surrogatepass"))
    rules = ("A report is set from its content", "are nested more than 32 deep", "Not a finite number")
    message = refuse_folder(sent, capsys)
    assert any(rule in message for rule in rules)


def test_an_oversized_report_is_refused(sent, capsys):
    with (sent / "report" / "figure-1.svg").open("r+b") as file:
        file.truncate(60_000_000)
    assert "larger than 50 MB" in refuse_folder(sent, capsys)


def test_text_is_never_markup(sent):
    change_content(
        sent, lambda blocks: blocks[0].update(text=[{"kind": "text", "text": '#read("secret.txt")'}])
    )
    assert run(["report", str(sent)]) == 0
