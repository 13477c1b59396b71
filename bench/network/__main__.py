"""Robots on hosts of their own, the network between them disturbed.

Takes: 35 minutes; 6 with --quick.
scripts/bench network
scripts/bench network -- --quick                                 lock-step and one repetition of the worst
scripts/bench network -- --part following --disturbance loss-50 --repetitions 5
"""

from __future__ import annotations

import signal
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

from namespaces import NetworkNotPermittedError, become_root_of_a_user_namespace, unshare_network

UNAVAILABLE = 69  # sysexits.h

if __name__ == "__main__":
    try:
        if not {"-h", "--help"} & set(sys.argv):
            become_root_of_a_user_namespace()  # before a library begins a thread
            unshare_network()
    except NetworkNotPermittedError as error:
        print(f"bench/network: {error}", file=sys.stderr)
        sys.exit(UNAVAILABLE)
    from cli import run

    signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))  # so that temporary folders go, too
    run()
