"""Make README's pictures and the output that it quotes: ``python docs/pictures.py``."""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "pictures"


def geomsim(*arguments: str, folder: Path) -> str:
    """Run a command in a folder and return what it prints."""
    command = [sys.executable, "-c", "from geomsim.cli import main; main()", *arguments]
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout


def main() -> None:
    """Write the pictures, and put what ``geomsim run office`` prints into README's first text block."""
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        printed = geomsim("run", "office", folder=folder)
        geomsim("discretize", "house", folder=folder)
        shutil.copy(folder / "geomsim-output/office-0/snapshots.png", PICTURES / "office.png")
        shutil.copy(folder / "geomsim-output/house-cells/cells.png", PICTURES / "house-cells.png")
    readme = ROOT / "README.md"
    text = readme.read_text(encoding="utf-8")
    block = f"```text\n{printed}```"
    readme.write_text(re.sub(r"```text\n.*?```", lambda _: block, text, count=1, flags=re.DOTALL), encoding="utf-8")


if __name__ == "__main__":
    main()
