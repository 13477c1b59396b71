"""The page of all pictures: one file that needs nothing but itself, whose links lead to files that exist."""

import base64
from html.parser import HTMLParser
from urllib.parse import unquote

import pytest
from every_picture import drawn, view

from pilotfish.plots.gallery import Gallery
from pilotfish.plots.page import Section, TextTable, write_page
from pilotfish.plots.style import DARK, LIGHT


class Reader(HTMLParser):
    """What a page refers to, and what it says."""

    def __init__(self, page):
        super().__init__()
        self.links, self.images, self.ids, self.captions, self.text = [], [], [], 0, ""
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        of = dict(attributes)
        assert not {"srcset", "data", "action"} & set(of)
        assert tag not in {"script", "link", "iframe", "object"}
        self.links += [of["href"]] if "href" in of else []
        self.images += [of["src"]] if "src" in of else []
        self.ids += [of["id"]] if "id" in of else []
        self.captions += tag == "figcaption"

    def handle_data(self, data):
        self.text += data


def check_page(folder):
    """The Reader of folder/index.html; fails if the page needs or links to anything that is not there."""
    page = Reader((folder / "index.html").read_text(encoding="utf-8"))
    for link in page.links:
        there = link[1:] in page.ids if link.startswith("#") else (folder / unquote(link)).is_file()
        assert there, link
    assert all(image.startswith("data:image/") for image in page.images)
    assert page.captions == len(page.images) > 0
    assert "http" not in page.text
    return page


def content_of(image):
    return base64.b64decode(image.partition(";base64,")[2])


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_the_page_holds_every_picture_and_links_to_its_file(tmp_path, kind):
    into = Gallery(tmp_path, kind)
    pictures = [
        into.save(drawn("paths"), "paths", "Paths", "Where they went."),
        into.save_gif([view(0.0), view(1.0)], "film", "Film", "What it saw."),
    ]
    write_page(tmp_path / "index.html", "All", "See.", [Section("Pictures", pictures=pictures)])
    page = check_page(tmp_path)
    assert [link for link in page.links if link[0] != "#"] == [f"paths.{kind}", "film.gif"]
    assert "Where they went." in page.text and "What it saw." in page.text
    drawing, film = map(content_of, page.images)
    if kind == "pdf":
        assert (tmp_path / "paths.pdf").read_bytes().startswith(b"%PDF")
        assert drawing.startswith(b"\x89PNG")  # browsers show no PDF as an image
    else:
        assert drawing == (tmp_path / f"paths.{kind}").read_bytes()
    assert film == (tmp_path / "film.gif").read_bytes()


def test_odd_names_and_texts_do_no_harm(tmp_path):
    (tmp_path / "a b#<i>.csv").write_text("")
    table = TextTable("<script>", [["<b>", "two"]], [("a & b", ["<i>2</i>"])], "note & note")
    section = Section("<h1>", "text < text", tables=[table])
    write_page(tmp_path / "index.html", "</title>", "$title & co", [section], [tmp_path / "a b#<i>.csv"])
    text = (tmp_path / "index.html").read_text()
    page = Reader(text)
    assert (tmp_path / unquote(page.links[-1])).is_file()
    for said in ("<script>", "a & b", "<i>2</i>", "note & note", "text < text", "$title & co", "a b#<i>.csv"):
        assert said in page.text


def test_a_dark_page_has_the_dark_colours(tmp_path):
    files = [write_page(tmp_path / t.name / "index.html", "t", "i", [], theme=t) for t in (LIGHT, DARK)]
    pages = [file.read_text() for file in files]
    assert DARK.ground in pages[1] and DARK.ground not in pages[0]
    assert 'content="light"' in pages[0] and 'content="dark"' in pages[1]


def test_a_format_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(ValueError, match="png, svg, pdf"):
        Gallery(tmp_path, "bmp")
