"""Diagnose: what the model of a campaign lacks."""

from html import escape
from pathlib import Path

from reliab.core.errors import InputError
from reliab.desk.elements import button, choice, dropper
from reliab.desk.folder import unpack_archive
from reliab.desk.jobs import Job
from reliab.desk.page import FiledPage
from reliab.desk.work import diagnose

_SHIPPED_CAMPAIGNS = ("rig_a", "rig_b", "rig_c")


class DiagnosePage(FiledPage):
    """One campaign."""

    name = "diagnose"
    title = "Diagnose"
    heading = "Diagnose a campaign"
    about = (
        "Give a campaign: its tests and campaign.toml. The desk finds where model and tests disagree, names "
        "what is missing, and proves it on held-out tests. This takes minutes."
    )
    work_kind = "diagnose"

    def build(self) -> None:
        """Lay out the form and the report."""
        self.lay_out_answer()
        options = {"the files that I dropped": ""}
        options |= {name: name for name in self.desk.folder.list_files(holding="campaign.toml")}
        options |= {f"{name}, which comes with reliab": name for name in _SHIPPED_CAMPAIGNS}
        self.form[:] = [
            dropper("Drop the zip of a campaign, or all its files", self.take_files, multiple=True),
            self.names,
            button("Remove all files", self.remove_files),
            choice(self.memory, "campaign", "Campaign", options),
            button("Diagnose", lambda: self.attempt(self._diagnose), "primary"),
            self.stop,
        ]

    def _campaign(self) -> str:
        campaign, files = self.memory.values.get("campaign", ""), self.memory.files
        if campaign:
            return campaign if campaign in _SHIPPED_CAMPAIGNS else str(self.desk.folder.within(campaign))
        if not files:
            raise InputError("A campaign is needed", value="none", remedy="Drop its zip, or choose one")
        archives = [path for path in files if path.suffix.lower() == ".zip"]
        return str(unpack_archive(archives[-1]) if archives else Path(files[0]).parent)

    def _diagnose(self) -> None:
        self.ask(diagnose, campaign=self._campaign())

    def show(self, kind: str, job: Job) -> None:
        """Show the statement as soon as it is there, then the report."""
        super().show(kind, job)
        if kind == self.work_kind and job.news and job.outcome is None:
            self.news.object = f'<p class="verdict" role="status">{escape(job.news[-1])}</p>'
        elif job.outcome is not None:
            self.news.object = ""
