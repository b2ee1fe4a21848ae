"""Rig: what its tests were, and what the next will be."""

import panel as pn

from reliab.core.shipped import shipped
from reliab.desk.elements import button, choice, field, html
from reliab.desk.page import FiledPage, Page
from reliab.desk.questions import select_filled
from reliab.desk.work import show_rig

_SAMPLE = "the rig that comes with reliab"
_ARGUMENTS = ("f", "xi", "alpha", "threshold")


def offer_rigs(page: Page, label: str, *, none: str = "") -> pn.widgets.Select:
    """Offer the rigs of the desk's folder, and the one that ships."""
    options = {
        **({none: ""} if none else {}),
        **{name: name for name in page.desk.folder.list_files(holding="tests/*.json")},
    }
    return choice(page.memory, "rig", label, {**options, _SAMPLE: _SAMPLE})


def path_of_rig(page: Page) -> str:
    """Return the folder of the rig that is chosen."""
    name = page.memory.values.get("rig", "")
    return (
        str(shipped("datasets", "sample_rig"))
        if name in ("", _SAMPLE)
        else str(page.desk.folder.within(name))
    )


class RigPage(FiledPage):
    """One rig."""

    name = "rig"
    title = "Rig"
    heading = "Follow a rig"
    about = "See what a rig has done, whether it drifts, and what its next test will be."
    work_kind = "rig"

    def build(self) -> None:
        """Lay out the form and the report."""
        self.form[:] = [
            html(
                "<p class='hint'>A rig is a folder that <b>reliab rig add</b> fills. Those in the folder "
                "of the desk are offered here.</p>"
            ),
            offer_rigs(self, "Rig"),
            html("<h2>The next test</h2><p class='hint'>Left empty: like the last one.</p>"),
            *(field(self.memory, name) for name in _ARGUMENTS),
            button("Show the rig", lambda: self.attempt(self._show), "primary"),
            self.stop,
        ]
        self.lay_out_answer()

    def _show(self) -> None:
        arguments = select_filled(self.memory.values, _ARGUMENTS)
        self.ask(show_rig, rig=path_of_rig(self), arguments=arguments)
