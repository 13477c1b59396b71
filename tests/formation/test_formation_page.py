"""What docs/formations.md shows is what there is."""

import re

import pytest
import yaml
from formation_files import HERE, formation

from page_commands import ROOT, blocks
from pilotfish.errors import ConfigError
from pilotfish.formation.file import read_formation
from pilotfish.formation.shapes import SHAPES

PAGE = "docs/formations.md"


def test_the_formation_of_the_page_can_be_loaded():
    (text,) = blocks(PAGE, "yaml")
    shown = read_formation(yaml.safe_load(text), HERE)
    assert len(shown.stages) == 3 and shown.stages[2].over_s == 2.0


def test_the_refusal_that_the_page_quotes_is_the_one_that_is_said():
    with pytest.raises(ConfigError) as refused:
        formation("wedge", angle_deg=35.0)
    said = str(refused.value).removeprefix("my_formation.yaml: ")
    assert said in " ".join((ROOT / PAGE).read_text().split())


def test_the_page_names_every_shape():
    assert set(SHAPES) <= set(re.findall(r"^\| `(\w+)` \|", (ROOT / PAGE).read_text(), flags=re.MULTILINE))


def test_the_python_of_the_page_compiles():
    (text,) = blocks(PAGE, "python")
    compile(text, PAGE, "exec")
