"""One self-contained HTML page: pictures with what they show, tables, links to the files beside it. Nothing is loaded
from anywhere, so the page can be sent alone; only its links need the folder."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template
from urllib.parse import quote

from pilotfish.plots.gallery import Picture
from pilotfish.plots.laws import law_colour
from pilotfish.plots.style import LIGHT, Theme
from pilotfish.whole_files import write_whole


@dataclass(frozen=True)
class TextTable:
    """A table of texts; ``rows`` are (label, one text a column)."""

    title: str
    columns: Sequence[Sequence[str]]  # the lines of each column's head
    rows: Sequence[tuple[str, Sequence[str]]]
    note: str = ""


@dataclass(frozen=True)
class Section:
    """A heading with what stands below it, in this order."""

    title: str
    text: str = ""
    tables: Sequence[TextTable] = ()
    pictures: Sequence[Picture] = ()


def write_page(
    file: Path, title: str, intro: str, sections: Sequence[Section], files: Sequence[Path] = (), theme: Theme = LIGHT
) -> Path:
    """Writes the page to ``file``, with a list of links to ``files``; all files lie in its folder or below."""
    body = [_section(section, file.parent) for section in sections]
    links = "".join(f"<li>{_link(path, file.parent)}</li>" for path in files)
    data = f'<section><h2>Data</h2><ul class="files">{links}</ul></section>' if files else ""
    contents = "".join(f'<a href="#{_anchor(section.title)}">{escape(section.title)}</a>' for section in sections)
    values = {"title": escape(title), "intro": escape(intro), "contents": contents, "legend": _legend(theme)}
    colours = {"background": theme.ground, "ink": theme.ink, "guide": theme.guide, "grid": theme.grid}
    page = _PAGE.substitute(values, body="".join(body) + data, scheme=theme.name, link=theme.anticipate, **colours)
    write_whole(file, page)
    return file


def _section(section: Section, folder: Path) -> str:
    parts = [f'<section id="{_anchor(section.title)}"><h2>{escape(section.title)}</h2>']
    parts += [f"<p>{escape(section.text)}</p>"] if section.text else []
    parts += [_table(table) for table in section.tables]
    parts += [_figure(picture, folder) for picture in section.pictures]
    return "".join([*parts, "</section>\n"])


def _figure(picture: Picture, folder: Path) -> str:
    content = base64.b64encode(picture.content).decode("ascii")
    image = f'<img src="data:{picture.mime_type};base64,{content}" alt="{escape(picture.title)}">'
    caption = f"<b>{escape(picture.title)}.</b> {escape(picture.shows)} {_link(picture.file, folder)}"
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>\n"


def _table(table: TextTable) -> str:
    heads = "".join(f"<th>{'<br>'.join(escape(line) for line in lines)}</th>" for lines in table.columns)
    rows = "".join(
        f"<tr><th>{escape(label)}</th>{''.join(f'<td>{escape(text)}</td>' for text in texts)}</tr>"
        for label, texts in table.rows
    )
    note = f"<p class='note'>{escape(table.note)}</p>" if table.note else ""
    caption = f"<caption>{escape(table.title)}</caption>"
    head = f"<thead><tr><th></th>{heads}</tr></thead>"
    return f'<div class="wide"><table>{caption}{head}<tbody>{rows}</tbody></table></div>{note}\n'


def _legend(theme: Theme) -> str:
    """What each colour means, in all pictures."""
    meanings = {
        "anticipate": law_colour("anticipate", theme),
        "paper": law_colour("paper", theme),
        "measured by the camera": theme.measured,
        "leader": theme.ink,
        "setpoints, bands, lines of sight": theme.guide,
    }
    spot = '<span class="spot" style="background:{}"></span>'
    return "".join(f"<li>{spot.format(colour)}{escape(text)}</li>" for text, colour in meanings.items())


def _link(path: Path, folder: Path) -> str:
    relative = path.relative_to(folder).as_posix()
    return f'<a href="{quote(relative)}">{escape(relative)}</a>'


def _anchor(title: str) -> str:
    return "".join(letter if letter.isalnum() else "-" for letter in title.lower())


_PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="$scheme">
<title>$title</title>
<style>
body { margin: 0 auto; max-width: 72rem; padding: 1rem; background: $background; color: $ink;
  font: 1rem/1.5 "DejaVu Sans", system-ui, sans-serif; }
a { color: $link; }
nav a { margin-right: 1.2rem; }
figure { margin: 1.5rem 0; }
img { display: block; max-width: 100%; height: auto; }
figcaption { max-width: 60rem; padding-top: 0.4rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: bold; padding-bottom: 0.4rem; }
th, td { padding: 0.15rem 0.9rem; border-bottom: 1px solid $grid; text-align: right; white-space: nowrap; }
th { vertical-align: bottom; }
tbody th { text-align: left; font-weight: normal; padding-left: 0; }
.note { color: $guide; margin-top: 0.3rem; }
.legend { list-style: none; padding: 0; display: flex; flex-wrap: wrap; gap: 0.2rem 1.5rem; }
.spot { display: inline-block; width: 1.6em; height: 0.35em; margin-right: 0.5em; vertical-align: middle; }
.files { columns: 18rem; }
</style>
</head>
<body>
<h1>$title</h1>
<p>$intro</p>
<ul class="legend">$legend</ul>
<nav>$contents</nav>
$body</body>
</html>
""")
