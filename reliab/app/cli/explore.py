"""`reliab explore`: a web page with sliders for the tolerable region."""

from reliab.app import questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say

_MEGABYTE = 1e6


@takes(questions.ExplorerQuestion)
def explore(request: Request) -> None:
    """Write an offline web page with sliders that show tolerable errors before a test."""
    from reliab.app.api.design import ExplorerPage, write_explorer

    def show(result: ExplorerPage) -> None:
        say(f"{result.page}: {result.size / _MEGABYTE:.1f} MB, open it in any browser.")

    request.answer(write_explorer, show)
