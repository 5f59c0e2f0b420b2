"""README is true: its commands and code run, and print what it says they print."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

README = Path(__file__).resolve().parents[1] / "README.md"
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
COMMANDS = [line for kind, text in BLOCKS if kind == "sh" for line in text.splitlines() if line.startswith("geomsim ")]
PROGRAMS = [text for kind, text in BLOCKS if kind == "python"]
PRINTED = [text for kind, text in BLOCKS if kind == "text"]
PLANS = [text for kind, text in BLOCKS if kind == "json"]
SCENARIOS = [text for kind, text in BLOCKS if kind == "toml"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the files that README's reader would have."""
    (tmp_path / "my_building.geojson").write_text(PLANS[0])
    (tmp_path / "search.toml").write_text(SCENARIOS[0])
    image = np.zeros((120, 200), np.uint8)
    image[10:110, 10:190] = 254
    image[10:60, 90:94] = 0
    cv2.imwrite(str(tmp_path / "my_map.png"), image)
    (tmp_path / "my_map.yaml").write_text(
        "image: my_map.png\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return tmp_path


def run(arguments: list[str], folder: Path) -> str:
    path = os.environ | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=folder, capture_output=True, text=True, check=False, env=path
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def geomsim(command: str, folder: Path) -> str:
    return run(["-c", "from geomsim.cli import main; main()", *shlex.split(command)[1:]], folder)


@pytest.mark.parametrize("command", COMMANDS)
def test_command(command: str, folder: Path) -> None:
    geomsim(command, folder)
    assert list(folder.glob("geomsim-output/*/*"))


def test_there_is_something_to_try() -> None:
    assert [len(blocks) for blocks in (COMMANDS, PROGRAMS, PRINTED, PLANS, SCENARIOS)] == [9, 1, 1, 1, 1]


@pytest.mark.parametrize("program", PROGRAMS)
def test_program(program: str, folder: Path) -> None:
    assert run(["-c", program], folder).startswith("captured after ")
    assert (folder / "pursuit.mp4").stat().st_size > 10_000


def test_what_run_office_prints(folder: Path) -> None:
    assert geomsim("geomsim run office", folder) == PRINTED[0]
