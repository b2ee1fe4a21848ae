"""Compare: several tests of one rig, ranked by their errors."""

from reliab.core.errors import InputError
from reliab.desk.elements import KNOWING, button, copyable, dropper, field, html
from reliab.desk.page import FiledPage
from reliab.desk.questions import command_line, select_filled
from reliab.desk.work import compare

_ARGUMENTS = ("f", "xi", "alpha", "threshold")


class ComparePage(FiledPage):
    """Several tests."""

    name = "compare"
    title = "Compare"
    heading = "Compare tests"
    about = "Drop tests of one structure and rig, such as one with each compensator, to rank them by error."
    work_kind = "compare"

    def build(self) -> None:
        """Lay out the form and the ranking."""
        self.lay_out_answer()
        self.form[:] = [
            dropper("1. Drop two tests or more", self.take_files, multiple=True),
            self.names,
            button("Remove all tests", self.remove_files),
            html("<h2>2. State their structure</h2>" + KNOWING),
            *(field(self.memory, name) for name in _ARGUMENTS),
            button("Compare", lambda: self.attempt(self._compare), "primary"),
            self.stop,
        ]

    def _compare(self) -> None:
        if len(self.memory.files) < 2:  # noqa: PLR2004 - a comparison is of two
            raise InputError(
                "A comparison needs two tests or more", value=len(self.memory.files), remedy="Drop another"
            )
        arguments = select_filled(self.memory.values, _ARGUMENTS)
        names = [path.name for path in self.memory.files]
        self.ask(compare, tests=list(map(str, self.memory.files)), arguments=arguments)
        self.lines[:] = [copyable("command", command_line("compare", names, arguments))]
