"""The Java parts of pilotfish-spy's plug-in, asked one question at a time (java/pilotfish/spy/Probe.java)."""

from __future__ import annotations

import subprocess
from pathlib import Path

from spy_screen import JARS, LCM_JAR

SOURCES = Path(__file__).parent / "java"


class Probe:
    """A running Java. Use as a context manager; `folder` gets its classes and the files it is asked about."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._files = 0
        classes = folder / "classes"
        path = ":".join(map(str, [LCM_JAR, *JARS]))
        compiling = ["javac", "-proc:none", "-cp", path, "-d", classes, SOURCES / "pilotfish/spy/Probe.java"]
        subprocess.run(compiling, check=True, capture_output=True, text=True)
        # One compiler and the simple collector: a short run starts in half the time.
        quick = ["-XX:TieredStopAtLevel=1", "-XX:+UseSerialGC", "-Xshare:auto", "-Xmx256m", "-Djava.awt.headless=true"]
        self._java = subprocess.Popen(
            ["java", *quick, "-cp", f"{classes}:{path}", "pilotfish.spy.Probe"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            encoding="utf-8",
        )

    def ask(self, *words: object) -> str:
        assert self._java.stdin and self._java.stdout
        self._java.stdin.write("\t".join(map(str, words)) + "\n")
        self._java.stdin.flush()
        answer = self._java.stdout.readline()
        assert answer, "the probe has ended"
        return answer.rstrip("\n")

    def file(self, data: bytes) -> Path:
        self._files += 1
        path = self.folder / f"message{self._files}"
        path.write_bytes(data)
        return path

    def __enter__(self) -> Probe:
        return self

    def __exit__(self, *_: object) -> None:
        assert self._java.stdin and self._java.stdout
        self._java.stdin.close()
        self._java.wait(10)
        self._java.stdout.close()
