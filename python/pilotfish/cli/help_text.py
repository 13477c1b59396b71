"""Docstrings as help: a terminal has its own width, so lines of running text are joined and wrapped anew."""

from __future__ import annotations

import inspect
import re

import typer


def flowing(docstring: str) -> str:
    """The text with the lines of each paragraph joined; blocks that begin with ``\\b`` stay as they are."""
    paragraphs = re.split(r"\n\s*\n", inspect.cleandoc(docstring))
    return "\n\n".join(
        paragraph if paragraph.lstrip(" ").startswith("\b") else " ".join(paragraph.split()) for paragraph in paragraphs
    )


def let_help_flow(app: typer.Typer) -> None:
    """Of every command of ``app`` and its groups that takes its help from its docstring."""
    for command in app.registered_commands:
        if command.help is None and command.callback is not None and command.callback.__doc__:
            command.help = flowing(command.callback.__doc__)
    for group in app.registered_groups:
        if group.typer_instance is not None:
            let_help_flow(group.typer_instance)
