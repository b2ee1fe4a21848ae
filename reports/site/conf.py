"""How the documentation site is built; see README.md beside this file."""

import os
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # for the extensions beside this file
os.environ["PYTHONPATH"] = str(Path(__file__).parent)  # for the figures that pages draw

from reliab.version import __version__

project = "reliab"
author = project_copyright = "The reliab developers"
release = version = __version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "formulas",
    "keys",
    "options",
]
exclude_patterns = ["README.md"]
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
smartquotes = False  # they would make a dash of the two hyphens of an option
html_title = f"reliab {__version__}"
html_show_sourcelink = False
html_copy_source = False
myst_enable_extensions = ["deflist", "colon_fence", "dollarmath"]
html_math_renderer = "mathml"
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_merge_streams = True
autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
copybutton_prompt_text = "$ "


def _name_functions(_app, _what, _name, _obj, _options, signature, returns):  # noqa: ANN001, ANN202
    """Write a default that is a function or a class by its name, not by where it lies."""
    text = re.sub(
        r"<(?:function|class) '?(?:[\w.<>]+\.)?(\w+|<lambda>)'?(?: at 0x[0-9a-f]+)?>", r"\1", signature or ""
    )
    return text or None, returns


def _keep_options_whole(_app, _page, _template, context, _doctree) -> None:  # noqa: ANN001
    """Let a command that wraps on a narrow screen break between words, not after the hyphens of an option."""
    context["body"] = re.sub(
        r'<div class="highlight-console.*?</pre>',
        lambda block: re.sub(r"(?<=[\s>])--?[a-z][\w-]*", r'<span class="pre">\g<0></span>', block[0]),
        context.get("body", ""),
        flags=re.DOTALL,
    )


def setup(app) -> None:  # noqa: ANN001 - Sphinx is not installed where types are checked
    """Take part in the build."""
    app.connect("autodoc-process-signature", _name_functions)
    app.connect("html-page-context", _keep_options_whole)
