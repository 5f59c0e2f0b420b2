"""What the pages in docs say is true: their commands and programs run, one after another, each page in a folder."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted(ROOT.glob("docs/*.md"))
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.DOTALL | re.MULTILINE)

#: what a shell block may hold: our own command; an installation is CI's to try
INSTALLS = re.compile(r"^(python3? -m venv|pip install|\. )")


def run(arguments: list[str], folder: Path) -> str:
    path = os.environ | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=folder, capture_output=True, text=True, check=False, env=path
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def carry_out(kind: str, text: str, folder: Path) -> None:
    """Do what a reader would do with a block: save it under the name that it or the page gives it, or run it."""
    named = re.match(r"# (\w+\.\w+)\n", text)
    if kind in ("python", "toml") and named:
        (folder / named[1]).write_text(text)
    elif kind == "boxes":
        (folder / "shed.boxes").write_text(text)
    elif kind == "python":
        run(["-c", text], folder)
    elif kind == "sh":
        for line in text.replace("\\\n", " ").splitlines():
            for command in line.partition("  #")[0].split(" && "):
                if INSTALLS.match(command) or not command.strip():
                    continue
                assert command.startswith("geomsim "), f"{command!r} is not tried by this test"
                run(["-c", "from geomsim.cli import main; main()", *shlex.split(command)[1:]], folder)
    else:
        assert kind in ("toml", "text", "json"), f"nobody knows what to do with a block of {kind}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_command_and_program_of_a_page_runs(page: Path, tmp_path: Path) -> None:
    if page.stem == "learning":
        pytest.importorskip("gymnasium")
        pytest.importorskip("pettingzoo")
    blocks = BLOCK.findall(page.read_text(encoding="utf-8"))
    assert bool(blocks) != (page.stem in ("index", "reference"))  # which have nothing to run
    for kind, text in blocks:
        carry_out(kind, text, tmp_path)
