"""The page of a reproduction: Markdown for the repository, and one HTML file with its pictures inside."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from pathlib import Path

from geomsim.files import write_text
from geomsim.trials.figures import draw_curves, draw_means
from geomsim.trials.paper import Part, Reproduction
from geomsim.trials.results import Trials

__all__ = ["write_page"]

_TITLE = "Section V, reproduced"
_LEAD = (
    "Hollinger, Kehagias and Singh, *Probabilistic Strategies for Pursuit in Cluttered Environments with Multiple "
    "Robots*: what the paper reports beside what comes out here."
)
_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 14px; }
th, td { text-align: left; padding: .3rem .8rem .3rem 0; border-bottom: 1px solid #ddd; vertical-align: top; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
td.differs { color: #b3261e; font-weight: 600; } td.agrees { color: #1b6e3c; }
img { max-width: 100%; height: auto; } h2 { margin-top: 2.5rem; }
"""

Cells = Sequence[tuple[str, ...]]


def write_page(result: Reproduction, folder: Path) -> dict[str, Path]:
    """Write ``reproduction.md`` with its pictures, and ``reproduction.html`` that needs no other file.

    Raises
    ------
    OutputError
        If they cannot be written.
    """
    pictures = {
        part.key: (
            draw_means(result.trials[part.key], folder / f"{part.key}-means.png"),
            draw_curves(result.trials[part.key], folder / f"{part.key}-curves.png"),
        )
        for part in result.parts
    }
    return {
        "markdown": write_text(folder / "reproduction.md", _markdown(result, pictures)),
        "html": write_text(folder / "reproduction.html", _html(result, pictures)),
    }


def _claims(result: Reproduction) -> tuple[tuple[str, ...], Cells]:
    rows = [
        (c.what, c.paper, c.ours, "" if c.ratio is None else f"{c.ratio:.2f}", "agrees" if c.agrees else "differs")
        for c in result.claims
    ]
    return ("", "paper", "here", "ratio", "verdict"), rows


def _table(trials: Trials) -> tuple[tuple[str, ...], Cells]:
    head = ("method", "mean, s", "SEM", "median, s", "captured", "predicted, s", "predicted / mean", "curve gap")
    rows = []
    for line in trials.summary().methods:
        seen = line.observed
        rows.append(
            (
                line.name,
                ("\u2265 " if seen.censored else "") + f"{seen.mean:.1f}",
                _told(seen.sem, 1),
                _told(seen.median, 1),
                f"{seen.captured_share:.1%}",
                f"{line.predicted:.1f}",
                f"{line.predicted / seen.mean:.2f}",
                f"{line.gap:.3f}",
            )
        )
    return head, rows


def _about(part: Part, trials: Trials) -> str:
    told = trials.summary()
    tau = told.rank_correlation
    return (
        f"{part.about} {told.trials} trials a method, {trials.engine} engine, {trials.wall_crossings} moves through "
        "walls." + ("" if tau is None else f" Kendall's tau between predicted and observed means: {tau:.2f}.")
    )


def _markdown(result: Reproduction, pictures: dict[str, tuple[Path, Path]]) -> str:
    parts = [f"# {_TITLE}", _LEAD]
    if result.claims:
        parts.append(_markdown_table(*_claims(result)))
    for part in result.parts:
        trials = result.trials[part.key]
        means, curves = (path.name for path in pictures[part.key])
        parts += [
            f"## {part.title}",
            _about(part, trials),
            _markdown_table(*_table(trials)),
            f"![Mean capture times]({means})",
            f"![Capture curves]({curves})",
        ]
    return "\n\n".join(parts) + "\n"


def _markdown_table(head: tuple[str, ...], rows: Cells) -> str:
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, ("---",) * len(head), *rows)]
    return "\n".join(lines)


def _html(result: Reproduction, pictures: dict[str, tuple[Path, Path]]) -> str:
    body = [f"<h1>{_TITLE}</h1>", f"<p>{html.escape(_LEAD.replace('*', ''))}</p>"]
    if result.claims:
        body.append(_html_table(*_claims(result), numbers=(3,)))
    for part in result.parts:
        trials = result.trials[part.key]
        body += [
            f"<h2>{html.escape(part.title)}</h2>",
            f"<p>{html.escape(_about(part, trials))}</p>",
            _html_table(*_table(trials), numbers=range(1, 8)),
        ]
        for path, alt in zip(pictures[part.key], ("Mean capture times", "Capture curves"), strict=True):
            data = base64.b64encode(path.read_bytes()).decode()
            body.append(f'<p><img alt="{alt}: {html.escape(part.title)}" src="data:image/png;base64,{data}"></p>')
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{_TITLE}</title>\n'
        f"<style>{_STYLE}</style>\n</head>\n<body>\n" + "\n".join(body) + "\n</body>\n</html>\n"
    )


def _html_table(head: tuple[str, ...], rows: Cells, numbers: Sequence[int]) -> str:
    def row(cells: tuple[str, ...], tag: str) -> str:
        kinds = [
            ("n" if k in numbers else cell if cell in ("agrees", "differs") else "") for k, cell in enumerate(cells)
        ]
        parts = [
            f"<{tag}{f' class={kind}' if kind else ''}>{html.escape(cell)}</{tag}>"
            for kind, cell in zip(kinds, cells, strict=True)
        ]
        return "<tr>" + "".join(parts) + "</tr>"

    return "<table>\n" + "\n".join([row(head, "th"), *(row(cells, "td") for cells in rows)]) + "\n</table>"


def _told(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
