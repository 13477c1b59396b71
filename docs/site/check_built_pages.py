"""Looks at the pages that Sphinx has built: python docs/site/check_built_pages.py FOLDER

Every link leads to a file that is there and to a place that is on it, and nothing is loaded from outside of the folder:
the site works from a disk without a network. Of Doxygen's pages in cpp/, only what is loaded is looked at: their links
are checked by Doxygen itself.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# What a browser loads by itself; a link (a, href) is only followed by people.
LOADED = {("link", "href"), ("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("video", "src")}
NOT_LOADED_RELATIONS = {"author", "canonical", "next", "prev", "index", "search"}


class Page(HTMLParser):
    """The links, loaded files and anchors of a page."""

    def __init__(self, text: str):
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        if values.get("id"):
            self.anchors.add(values["id"])
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        relations = set((values.get("rel") or "").split())
        for name in ("href", "src"):
            if (tag, name) in LOADED and values.get(name) and not relations & NOT_LOADED_RELATIONS:
                self.loaded.append(values[name])


def findings(folder: Path) -> list[str]:
    """What is wrong, a line each."""
    pages = {path.resolve(): Page(path.read_text(errors="replace")) for path in sorted(folder.rglob("*.html"))}
    found = []
    for path, page in pages.items():
        name = path.relative_to(folder.resolve())
        found += [f"{name}: loads {address}" for address in page.loaded if urlsplit(address).netloc]
        if name.parts[0] == "cpp":
            continue
        for address in [*page.links, *page.loaded]:
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                found.append(f"{name}: {address} is not there")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                found.append(f"{name}: {address} has no such place")
    return found if pages else [f"{folder}: there are no pages"]


if __name__ == "__main__":
    wrong = findings(Path(sys.argv[1]))
    for line in wrong:
        print(line, file=sys.stderr)
    sys.exit(1 if wrong else 0)
