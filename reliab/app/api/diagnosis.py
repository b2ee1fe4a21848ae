"""`diagnose_campaign`: where a model fails, what is missing, the proof, and its files."""

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

from reliab.core.files import refuse_unwritable, write_json_file
from reliab.core.progress import show_task
from reliab.discrepancy.adding import Addition, add
from reliab.discrepancy.campaign.reading import campaign_folder, read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.report.document import Document
from reliab.report.kinds.discrepancy_report import discrepancy_report
from reliab.report.setting import ReportSetting
from reliab.study.stages import digest

_RESULT = "diagnosis.json"
_REPORT = "report.pdf"


def diagnose_campaign(
    campaign: str | Path,
    *,
    out: str | Path | None = None,
    tell: Callable[[Diagnosis], None] = lambda _diagnosis: None,
) -> Addition:
    """Find where simulation and measurement disagree, name what is missing, and add it to the model.

    Diagnosis and updated model are written to `out`; `report_diagnosis` adds the
    report. `tell` is called with the diagnosis once it is there, before its posteriors are sampled.
    """
    folder = campaign_folder(campaign)
    tests = read_campaign(folder)
    if out is not None:
        with refuse_unwritable("Cannot write to the folder for the diagnosis", where=out):
            Path(out).mkdir(parents=True, exist_ok=True)
    with show_task("Searching the blocks") as progress:
        diagnosis = diagnose(tests, progress=progress)
    tell(diagnosis)
    with show_task("Sampling posteriors") as progress:
        addition = add(diagnosis, out=None if out is None else Path(out), progress=progress)
    if out is not None:
        write_json_file(addition.to_dict(), Path(out) / _RESULT)
    return addition


def report_diagnosis(
    addition: Addition, campaign: str | Path, out: str | Path, *, setting: ReportSetting | None = None
) -> None:
    """Write the report of a diagnosed campaign into the folder of its diagnosis.

    Parameters
    ----------
    addition : Addition
        What :func:`diagnose_campaign` returned.
    campaign : str or pathlib.Path
        Folder of the campaign, or its name.
    out : str or pathlib.Path
        Folder of the diagnosis.
    setting : Setting, optional
        How the report is set.

    Raises
    ------
    InputError
        If the report cannot be written.
    """
    from reliab.report.pdf import write_pdf

    newest = max(path.stat().st_mtime for path in campaign_folder(campaign).iterdir())
    day = datetime.fromtimestamp(newest, tz=UTC).date()
    write_pdf(document_of_diagnosis(addition, campaign), Path(out) / _REPORT, date=day, setting=setting)


def document_of_diagnosis(addition: Addition, campaign: str | Path) -> Document:
    """Make the document that :func:`report_diagnosis` sets as a PDF."""
    folder = campaign_folder(campaign)
    return discrepancy_report(
        addition.diagnosis,
        posteriors=addition.posteriors,
        provenance={"campaign": folder.name, "campaign, SHA-256": digest(folder)},
    )
