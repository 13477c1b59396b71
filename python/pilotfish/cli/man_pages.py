"""Man pages of ``pilotfish`` and of each of its commands, from the same structure that ``--help`` is printed from.

    python -m pilotfish.cli.man_pages packaging/man/pilotfish

writes them anew. They stand in the repository, because where a package is built the command line cannot run; a test
compares them. The format is that of man(7).
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from enum import Enum
from itertools import takewhile
from pathlib import Path
from typing import Any, get_args

from rich.markup import render

from pilotfish import __version__

EXIT_STATUS = {
    0: "Done.",
    1: "A check has findings: replay --assert, doctor, leader check, fuzzy check, a calibration with --truth.",
    64: "The command line is wrong.",
    65: "A file that is no recording or shows too little; a calibration that must be done again.",
    66: "A file to read that is not there.",
    69: "No robot answers; the camera or the bus cannot be opened; a Python package is missing, and the message says "
    "how to install it.",
    70: "A robot answers and does not comply.",
    74: "What cannot be written.",
    78: "A configuration, leader or calibration is wrong; the message names the key.",
    129: "SIGHUP: its terminal was closed, its connection lost.",
    130: "Ctrl-C.",
    141: "A pipe without a reader.",
    143: "SIGTERM.",
}
PROGRAMS = ("pilotfish-base", "pilotfish-coordinator", "pilotfish-sim", "pilotfish-spy")
_TITLE_MAX = 60  # characters: what is longer is a sentence, and no heading


def pages() -> dict[str, str]:
    """File name -> text in man(7)'s format, of the program, of its groups and of every command that is not hidden."""
    import typer.main

    from pilotfish.cli import app

    root = typer.main.get_command(app)
    return {f"{'-'.join(words)}.1": _page(words, context) for words, context in _contexts(root, ("pilotfish",), None)}


def _contexts(command: Any, words: tuple[str, ...], parent: Any) -> Iterator[tuple[tuple[str, ...], Any]]:
    context = command.context_class(command, info_name=words[-1], parent=parent, **command.context_settings)
    yield words, context
    for name, inner in sorted(getattr(command, "commands", {}).items()):
        if not inner.hidden:
            yield from _contexts(inner, (*words, name), context)


def _page(words: tuple[str, ...], context: Any) -> str:
    command, name = context.command, "-".join(words)
    summary, sections = _sections(command.help or "")
    lines = [
        f'.TH "{_escaped(name.upper())}" 1 "" "pilotfish {__version__}" "Pilotfish"',
        ".SH NAME",
        f"{_escaped(name)} \\- {_escaped(_first_sentence(summary))}",
        ".SH SYNOPSIS",
        f".B {_escaped(' '.join(words))}",
        _escaped(_usage(command, context)),
        ".SH DESCRIPTION",
        *_paragraphs(summary),
    ]
    for heading, verbatim in sections:
        if not _is_example(heading):
            title = [f".SS {_escaped(heading)}"] if len(heading) <= _TITLE_MAX else [".PP", *_text(heading)]
            lines += [*title, *_verbatim(verbatim)]
    lines += _parameters(command, context)
    if inner := getattr(command, "commands", None):
        lines.append(".SH COMMANDS")
        for inner_name, one in sorted(inner.items()):
            if not one.hidden:
                first = _first_sentence(_sections(one.help or "")[0])
                page = "-".join((*words, inner_name))
                lines += [".TP", f".BR {_escaped(page)} (1)", *_text(first)]
    lines.append(".SH EXIT STATUS")
    for code, meaning in EXIT_STATUS.items():
        lines += [".TP", f".B {code}", *_text(meaning)]
    lines += [
        ".SH ENVIRONMENT",
        ".TP",
        ".B LCM_DEFAULT_URL",
        *_text("The bus, where the command line names none. Without either: this host alone."),
    ]
    for heading, verbatim in sections:
        if _is_example(heading):
            what = heading.partition(": ")[2]
            lines += [".SH EXAMPLES", *_text(what), *_verbatim(verbatim)]
    also = _see_also(words, context)
    lines += [".SH SEE ALSO", *(f".BR {_escaped(each)} (1)," for each in also[:-1]), f".BR {_escaped(also[-1])} (1)"]
    return "\n".join(lines) + "\n"


def _sections(text: str) -> tuple[str, list[tuple[str, list[str]]]]:
    """The running text, and of each block that is not to be rewrapped (``\\b`` alone on its line): its heading, and the
    lines that are indented below it, without that indentation. A block without such lines is running text."""
    summary, sections = [], []
    for paragraph in re.split(r"\n\s*\n", text.strip()):
        lines = paragraph.strip("\n").splitlines()
        is_block = bool(lines) and lines[0].strip() == "\b"
        lines = lines[1:] if is_block else lines
        heading = list(takewhile(lambda line: not line.startswith(" "), lines))
        verbatim = lines[len(heading) :]
        if is_block and verbatim:
            indent = min(len(line) - len(line.lstrip()) for line in verbatim if line.strip())
            title = _plain(" ".join(heading)).rstrip(":")
            sections.append((title, [_plain(line[indent:]) for line in verbatim]))
        else:
            summary.append(_plain(" ".join(line.strip() for line in lines)))
    return "\n\n".join(summary), sections


def _parameters(command: Any, context: Any) -> list[str]:
    """The arguments, and the options panel by panel, in the order of ``--help``."""
    arguments, panels = [], {}
    for param in command.get_params(context):
        if getattr(param, "hidden", False):
            continue
        if param.param_type_name == "argument":
            arguments += [".TP", f".I {_escaped(_argument_name(param))}", *_text(_plain(_help(param)))]
            continue
        names = "/".join(", ".join(f"\\fB{_escaped(each)}\\fR" for each in each_of) for each_of in _names(param))
        value = "" if param.is_flag else f" \\fI{_escaped(_value_name(param))}\\fR"
        panel = getattr(param, "rich_help_panel", None) or ""
        panels.setdefault(panel, []).extend([".TP", f"{names}{value}", *_text(_plain(_help(param)))])
    lines = [".SH ARGUMENTS", *arguments] if arguments else []
    if panels:
        lines.append(".SH OPTIONS")
        for panel, entries in panels.items():
            lines += [f".SS {_escaped(panel)}" for _ in [0] if panel] + entries
    return lines


def _names(param: Any) -> list[list[str]]:
    """Of an option and of its opposite, a single letter first."""
    both = (sorted(each, key=lambda name: name.startswith("--")) for each in (param.opts, param.secondary_opts))
    return [each for each in both if each]


def _is_example(heading: str) -> bool:
    return heading.partition(":")[0] in ("Example", "Examples")


def _usage(command: Any, context: Any) -> str:
    """What follows the command's name."""
    pieces = ["[OPTIONS]"]
    for param in command.get_params(context):
        if param.param_type_name == "argument":
            name = _argument_name(param) + ("..." if param.nargs == -1 else "")
            pieces.append(name if param.required else f"[{name}]")
    return " ".join([*pieces, *(["COMMAND [ARGS]..."] if hasattr(command, "commands") else [])])


def _argument_name(param: Any) -> str:
    return param.metavar or param.name.upper()


def _value_name(param: Any) -> str:
    """What stands for an option's value: its own word, the choices, or what kind of value it is."""
    if param.metavar:
        return param.metavar
    kind = param.type_descriptor.annotation
    kind = next(iter(get_args(kind)), kind)  # of a list
    if isinstance(kind, type) and issubclass(kind, Enum):
        return "|".join(str(one.value) for one in kind)
    return {int: "INTEGER", float: "NUMBER", Path: "PATH"}.get(kind, "TEXT")


def _help(param: Any) -> str:
    """The text of a parameter with its default, as ``--help`` shows it."""
    text = param.help or ""
    if getattr(param, "required", False) and param.param_type_name == "option":
        return f"{text} Required."
    shown = param.show_default
    if isinstance(shown, str):
        return f"{text} Default: {shown}."
    default = param.default
    if param.param_type_name == "argument" or default in (None, "", (), [], False) or callable(default) or not shown:
        return text
    if getattr(param, "is_flag", False):
        name = param.opts[0] if default else (param.secondary_opts or [""])[0]
        return f"{text} Default: {name.lstrip('-')}." if param.secondary_opts else text
    default = getattr(default, "value", default)
    values = default if isinstance(default, (list, tuple)) else [default]
    return f"{text} Default: {' '.join(f'{value:g}' if isinstance(value, float) else str(value) for value in values)}."


def _see_also(words: tuple[str, ...], context: Any) -> list[str]:
    """The page above, its neighbours in a group, and the programs."""
    above = ["-".join(words[:-1])] if len(words) > 1 else []
    inside = []
    if len(words) > 2:
        commands = context.parent.command.commands.items()
        inside = [
            "-".join((*words[:-1], name)) for name, one in sorted(commands) if not one.hidden and name != words[-1]
        ]
    return [*above, *inside, *PROGRAMS]


def _plain(text: str) -> str:
    """Without rich's markup."""
    return render(text).plain


def _first_sentence(text: str) -> str:
    first = text.partition("\n\n")[0]
    return re.split(r"(?<=[a-z0-9)])\. ", first)[0].rstrip(".:")


def _paragraphs(text: str) -> list[str]:
    lines: list[str] = []
    for paragraph in text.split("\n\n"):
        lines += [".PP", *_text(paragraph)]
    return lines[1:]


def _verbatim(lines: list[str]) -> list[str]:
    return [".nf", *(_escaped(line) for line in lines), ".fi"]


def _text(text: str) -> list[str]:
    """A line a sentence: what man(7) wants, and what makes differences readable."""
    return [_escaped(sentence) for sentence in re.split(r"(?<=[a-z0-9)'`][.]) (?=[A-Z])", text.strip()) if sentence]


def _escaped(text: str) -> str:
    r"""As man(7) prints it literally: of \ a \e, of - no hyphen, of " no argument's end, and of a line that begins with
    . or ' no request."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace('"', "\\(dq")
    return f"\\&{text}" if text.startswith((".", "'")) else text


def write(folder: Path) -> list[Path]:
    """Writes all pages into ``folder``; removes those of commands that are no more."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = pages()
    for old in folder.glob("pilotfish*.1"):
        if old.name not in texts:
            old.unlink()
    written = []
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
        written.append(folder / name)
    return written


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m pilotfish.cli.man_pages FOLDER")
    print(f"wrote {len(write(Path(sys.argv[1])))} pages to {sys.argv[1]}")
