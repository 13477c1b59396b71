"""Sphinx of the whole site: guides in Markdown, the Python reference from docstrings. scripts/docs runs it."""

import re
from pathlib import Path

import pilotfish

project = "Pilotfish"
author = "the authors of Pilotfish"
version = release = pilotfish.__version__
extensions = ["sphinx.ext.autodoc", "myst_parser"]

html_theme = "furo"
html_title = "Pilotfish"
html_show_copyright = False
html_copy_source = False
html_show_sourcelink = False
# The summaries of a search are fetched from the pages found, which no browser does for file://.
html_show_search_summary = False
html_search_scorer = str(Path(__file__).with_name("scorer.js"))
highlight_language = "none"  # what has no language is a diagram or an output
myst_heading_anchors = 6  # as on a forge: docs/page.md#a-heading
myst_links_external_new_tab = False
suppress_warnings = ["myst.header"]  # a guide may begin below another level

default_role = "code"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "undoc-members": True}
autodoc_typehints = "signature"
autoclass_content = "both"
add_module_names = False
python_use_unqualified_type_names = True
# Packages of extras are not needed to read docstrings.
autodoc_mock_imports = [
    "av",
    "cv2",
    "mcap",
    "optuna",
    "pyarrow",
    "reportlab",
    "starlette",
    "textual",
    "uvicorn",
    "websockets",
]

SHORTER = {
    "typing.SupportsFloat | typing.SupportsIndex": "float",
    "typing.SupportsInt | typing.SupportsIndex": "int",
    "collections.abc.": "",
    "os.PathLike | str | bytes": "PathLike | str",
    "typing.": "",
}


def shorten(_app, _what, _name, _obj, _options, signature, returns):
    """What a caller has to pass, without pybind11's protocols and without self."""

    def short(text: str | None) -> str | None:
        if text is None:
            return None
        for long, brief in SHORTER.items():
            text = text.replace(long, brief)
        return re.sub(r"\(self(: [\w.]+)?(, )?", "(", text, count=1)

    return short(signature), short(returns)


def example_as_code(_app, what, _name, _obj, _options, lines):
    """The example that ends a module's docstring, from its first import on, is a block of code."""
    starts = [number for number, line in enumerate(lines) if line.startswith("from pilotfish")]
    if what == "module" and starts:
        code = lines[starts[0] :]
        lines[starts[0] :] = [".. code-block:: python", "", *(f"   {line}" for line in code)]


def escape(_app, _what, _name, _obj, _options, lines):
    """Docstrings are plain text: a * or | in a formula, or a name that ends in _, is no markup."""
    if ".. code-block:: python" in lines:
        code = lines[lines.index(".. code-block:: python") :]
        del lines[-len(code) :]
    else:
        code = []
    for number, line in enumerate(lines):
        if not line.lstrip().startswith((":", ".. ")):
            parts = re.split(r"(``[^`]*``|`[^`]*`)", line)
            lines[number] = "".join(
                part if part.startswith("`") else re.sub(r"([*|\\])|(?<=\w)(_)(?=\W|$)", r"\\\g<0>", part)
                for part in parts
            )
    lines += code


def setup(app):
    app.connect("autodoc-process-signature", shorten)
    app.connect("autodoc-process-docstring", example_as_code)
    app.connect("autodoc-process-docstring", escape)
