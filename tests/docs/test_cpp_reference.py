"""Doxygen understands every public header, and finds every name in it documented (scripts/docs makes the pages)."""

import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_doxygen_warns_of_nothing_in_the_public_headers(tmp_path):
    doxyfile = tmp_path / "Doxyfile"
    # XML, which takes a fifth of the time of the pages.
    settings = f"OUTPUT_DIRECTORY = {tmp_path}\nGENERATE_HTML = NO\nGENERATE_XML = YES\nXML_PROGRAMLISTING = NO\n"
    doxyfile.write_text((ROOT / "docs/api/Doxyfile").read_text() + settings)
    done = subprocess.run(["doxygen", doxyfile], cwd=ROOT, check=False, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(list((tmp_path / "xml").glob("*classpilotfish*.xml"))) > 40
    remembered = (tmp_path / "xml" / "classpilotfish_1_1vision_1_1LeaderObserver.xml").read_text()
    assert "core/checkpoint.hpp" in remembered  # a comment behind an opening brace, too
    assert "&lt; see" not in remembered
