"""`reliab explore`: a web page with sliders for the tolerable region."""

from reliab.app import questions
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import say, write_json

_MEGABYTE = 1e6


@takes(questions.Explorer)
def explore(asked: Asked) -> None:
    """Write an offline web page with sliders that show tolerable errors before a test."""
    from reliab.app.api.explorer import write_explorer

    written = asked.ask(write_explorer, "json_target")
    if not write_json(written.to_dict(), asked.json_target):
        size = written.size / _MEGABYTE
        say(f"{written.page}: {size:.1f} MB, open it in any browser.")
