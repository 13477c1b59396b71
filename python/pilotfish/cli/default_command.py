"""Groups with a command that is meant where none is named: `pilotfish sweep FILE` is `pilotfish sweep run FILE`."""

from __future__ import annotations

from typing import Any, ClassVar

import typer.core


class DefaultCommandGroup(typer.core.TyperGroup):
    """A group whose command ``default`` takes what names none of the others."""

    default: ClassVar[str]

    def with_default(self, args: list[str]) -> list[str]:
        """With the default in front of what is no subcommand."""
        return args if not args or args[0] in self.commands else [self.default, *args]

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As click's, with the default."""
        asks = bool(args) and args[0] in ctx.help_option_names
        return super().parse_args(ctx, args if asks else self.with_default(args))

    def shell_complete(self, ctx: Any, incomplete: str) -> list[Any]:
        """As click's, and what the default's first argument may be."""
        command = self.commands[self.default]
        inner = command.make_context(self.default, [], parent=ctx, resilient_parsing=True)
        arguments = [param for param in command.params if param.param_type_name == "argument"]
        proposed = [each for param in arguments[:1] for each in param.shell_complete(inner, incomplete)]
        return [*super().shell_complete(ctx, incomplete), *proposed]
