"""The nftables rule that keeps other hosts off LCM's port, between two network namespaces joined by a cable."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

RULES = Path(__file__).parents[2] / "packaging" / "nftables" / "pilotfish.nft"
AS_ROOT = [] if os.geteuid() == 0 else ["--map-root-user"]


def in_a_network_of_its_own(*command):
    words = ["unshare", "--net", *AS_ROOT, *map(str, command)]
    return subprocess.run(words, capture_output=True, text=True, timeout=60)


if in_a_network_of_its_own("nft", "list", "ruleset").returncode != 0:
    pytest.skip("no nft, or no network namespaces here", allow_module_level=True)


def test_nft_understands_the_rules():
    done = in_a_network_of_its_own("nft", "-c", "-f", RULES)
    assert done.returncode == 0, done.stderr


def test_only_this_host_is_heard_on_the_port_of_lcm():
    done = in_a_network_of_its_own(sys.executable, Path(__file__).with_name("two_hosts.py"), RULES)
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout)
    assert seen["open"] == ["inside", "outside", "outside, to us alone"], "without the rule all are received"
    assert seen["guarded"] == ["inside"]
    assert seen["dropped"] == 10  # 5 to the group and 5 to this host alone
