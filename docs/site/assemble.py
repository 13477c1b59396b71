"""Lays out the site's pages for Sphinx: python docs/site/assemble.py FOLDER

The documents are written for a forge: they link to each other and to any file of the repository by relative paths.
Here they are copied into one tree, docs/ to its top and the rest below repository/, with the links adapted. What is
linked and is no document (sources, configuration, folders) becomes a page with its text. The sidebar is made from the
lists in docs/index.md, so that the order of pages is written once.
"""

import posixpath
import re
import shutil
import sys
from pathlib import Path

from markdown_links import headings, is_outside, resolved, targets, with_targets_replaced

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "bench/README.md", "examples/README.md")
DECISIONS = "docs/decisions"
CPP_REFERENCE = "docs/api/mainpage.md"
LANGUAGES = {".cpp": "cpp", ".hpp": "cpp", ".py": "python", ".yaml": "yaml"}


def documents() -> list[str]:
    """Every page that people have written, as paths from the repository's root."""
    guides = [*ROOT.glob("docs/*.md"), *ROOT.glob(f"{DECISIONS}/*.md"), *ROOT.glob("docs/api/python/*.rst")]
    return [*DOCUMENTS, CPP_REFERENCE, *sorted(str(path.relative_to(ROOT)) for path in guides)]


def place(path: str) -> str:
    """Where a file or folder of the repository is in the site's sources."""
    if path == DECISIONS:
        return "decisions/index.md"
    if (ROOT / path).is_dir():
        return place(f"{path}/README.md") if (ROOT / path / "README.md").is_file() else f"repository/{path}.md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return f"repository/{path}" if path.endswith(".md") else f"repository/{path}.md"


def adapted(page: str, target: str) -> str:
    """A link of a page, as it has to be in the site's sources."""
    if is_outside(target) or target.startswith("#"):
        return target
    path, fragment = resolved(page, target)
    relative = posixpath.relpath(place(path), posixpath.dirname(place(page)) or ".")
    return f"{relative}#{fragment}" if fragment else relative


def sections(index: str) -> list[tuple[str, list[tuple[str, str]]]]:
    """The sidebar: each heading of docs/index.md with the titles and targets listed below it."""
    parts = re.split(r"^## (.*)$", index, flags=re.MULTILINE)[1:]
    return [
        (caption, re.findall(r"^- \[(.*)\]\((.*)\)$", body, flags=re.MULTILINE))
        for caption, body in zip(parts[::2], parts[1::2], strict=True)
    ]


def toctree(caption: str, entries: list[tuple[str | None, str]]) -> str:
    """A table of contents that only the sidebar shows: pages with the titles given, or with their own (None)."""
    names = [(title, "/" + re.sub(r"[.](md|rst)$", "", source)) for title, source in entries]
    lines = [f"{title} <{name}>" if title else name for title, name in names]
    return "\n".join(["```{toctree}", ":hidden:", f":caption: {caption}", "", *lines, "```", ""])


def index_page() -> str:
    """docs/index.md with the sidebar."""
    text = (ROOT / "docs/index.md").read_text()
    trees = [
        toctree(caption, [(title, place(resolved("docs/index.md", target)[0])) for title, target in entries])
        for caption, entries in sections(text)
    ]
    return "\n".join([with_targets_replaced(text, lambda target: adapted("docs/index.md", target)), *trees])


def decisions_page() -> str:
    """A list of all decisions by their titles."""
    files = sorted((ROOT / DECISIONS).glob("*.md"))
    titles = [(headings(path.read_text())[0], path.name) for path in files]
    lines = ["# Decisions", "", "What was chosen, what was not, and why.", ""]
    lines += [f"- [{title}]({name})" for title, name in titles]
    return "\n".join([*lines, "", toctree("Decisions", [(None, f"decisions/{name}") for _, name in titles])])


def source_page(path: str) -> str:
    """A file that a document links to, as a page; it is not searched."""
    text = (ROOT / path).read_text()
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    language = LANGUAGES.get(Path(path).suffix, "none")
    return f"---\norphan: true\nnosearch: true\n---\n# {path}\n\n{fence}{language}\n{text}\n{fence}\n"


def folder_page(path: str) -> str:
    """A folder that a document links to: its files."""
    names = sorted(file.name for file in (ROOT / path).iterdir() if file.is_file())
    lines = [f"- [{name}]({posixpath.basename(path)}/{name}.md)" for name in names]
    return "\n".join(["---\norphan: true\nnosearch: true\n---", f"# {path}", "", *lines, ""])


def document_page(path: str) -> str:
    """A document with its links adapted."""
    text = (ROOT / path).read_text()
    if path.endswith(".rst"):
        return f".. highlight:: python\n\n{text}"
    text = with_targets_replaced(text, lambda target: adapted(path, target))
    if path == CPP_REFERENCE:  # Doxygen's pages lie beside Sphinx's
        text += '\n<p><a href="../cpp/index.html">Every class and function of the C++ library</a></p>\n'
    return text


def linked(page: str) -> list[str]:
    """The files and folders of the repository that a page links to; of a folder that has a README.md, that."""
    if not page.endswith(".md"):
        return []
    inside = (target for target in targets((ROOT / page).read_text()) if not is_outside(target))
    paths = (resolved(page, target)[0] for target in inside)
    return [f"{path}/README.md" if (ROOT / path / "README.md").is_file() else path for path in paths]


def broken_links() -> list[str]:
    """Links of documents that lead to no file of the repository, a line each."""
    return [
        f"{page}: {path} is not there" for page in documents() for path in linked(page) if not (ROOT / path).exists()
    ]


def pages() -> dict[str, str]:
    """Every page of the site's sources, by its path there."""
    written = documents()
    made = {place(path): document_page(path) for path in written}
    made["index.md"] = index_page()
    made["decisions/index.md"] = decisions_page()
    for path in sorted({path for page in written for path in linked(page)}):
        if place(path) in made or path.endswith(".png"):
            continue
        made[place(path)] = folder_page(path) if (ROOT / path).is_dir() else source_page(path)
        if (ROOT / path).is_dir():
            files = (str(file.relative_to(ROOT)) for file in (ROOT / path).iterdir() if file.is_file())
            made |= {place(file): source_page(file) for file in files if place(file) not in made}
    return made


def assemble(folder: Path) -> None:
    """Writes the site's sources. A page that did not change is left as it is, so that Sphinx need not read it again."""
    made = pages()
    for old in [*folder.rglob("*.md"), *folder.rglob("*.rst")]:
        if str(old.relative_to(folder)) not in made:
            old.unlink()
    for path, text in made.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        if not file.is_file() or file.read_text() != text:
            file.write_text(text)
    shutil.copytree(ROOT / "docs/images", folder / "images", dirs_exist_ok=True)


if __name__ == "__main__":
    if broken := broken_links():
        sys.exit("\n".join(broken))
    assemble(Path(sys.argv[1]))
