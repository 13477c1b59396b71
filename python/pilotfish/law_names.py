"""The names of the laws, as tables, legends and titles show them."""

from __future__ import annotations

_NAMES = {"pbvs": "ViSP's servo", "pid": "PID"}


def law_name(law: str) -> str:
    """The field's name of what ``--law`` and ``--profile`` choose: pbvs is ViSP's servo."""
    return _NAMES.get(law, law)
