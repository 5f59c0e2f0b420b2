"""Guided by coverage, look for files that readers fail on: ``python tests/fuzz/fuzz_readers.py SVG 300``.

Needs ``pip install atheris`` (part of the ``dev`` extra). The first argument is the beginning of a format's name, or
``scenario``; the second how many seconds to run, 60 by default. It ends with a traceback at the first input that
raises anything but a GeomsimError, takes more than 10 s or 1 GiB, and leaves that input beside it as ``crash-...``.
"""

import sys
import tempfile
from pathlib import Path

import atheris

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

with atheris.instrument_imports(include=["maps", "geomsim"]):
    from geomsim.scenario import read_scenario
    from maps import GeomsimError, read_plan

from tests.fuzz.examples import EXAMPLES, SCENARIO


def main() -> None:
    """Fuzz what the command line names."""
    wanted, seconds = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "60"
    examples = EXAMPLES | {"scenario": ("scenario.toml", SCENARIO, {})}
    name = next(name for name in examples if name.lower().startswith(wanted.lower()))
    file, content, options = examples[name]
    folder = Path(tempfile.mkdtemp(prefix="geomsim-fuzz-"))
    (folder / "map.png").write_bytes(EXAMPLES["picture"][1])
    corpus = folder / "corpus"
    corpus.mkdir()
    (corpus / "whole").write_bytes(content)
    path = folder / file

    def one(data: bytes) -> None:
        path.write_bytes(data)
        try:
            if name == "scenario":
                read_scenario(path, {})
            else:
                read_plan(path, **options)
        except GeomsimError:
            pass

    limits = [f"-max_total_time={seconds}", "-timeout=10", "-rss_limit_mb=1024", "-max_len=65536"]
    atheris.Setup([sys.argv[0], *limits, str(corpus)], one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
