"""``python -m maps.drafts`` writes the bundled plans anew."""

from pathlib import Path

from maps.drafts import write_drafts

if __name__ == "__main__":
    write_drafts(Path(__file__).resolve().parent.parent / "bundled")
