"""Drawing as vectors: SVG and PDF by matplotlib, which is imported only here and only when it is needed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.surface import Align
from geomsim.drawing.theme import DrawingError
from geomsim.drawing.viewport import Box
from geomsim.files import replacing
from maps import nearest

if TYPE_CHECKING:
    from matplotlib.artist import Artist

__all__ = ["VectorSheet", "is_vector"]

_INCHES = 7.0  # the width of two columns of a paper
_POINTS = 72.0 * _INCHES


def is_vector(path: Path) -> bool:
    """Tell by its name whether a picture is written as vectors or as PNG.

    Raises
    ------
    DrawingError
        If it can be neither.
    """
    kinds = {".png": False, ".svg": True, ".pdf": True}
    kind = path.suffix.lower()
    if kind not in kinds:
        raise DrawingError(f"A picture cannot be written as {path.name!r}: {nearest(path.suffix, kinds)}")
    return kinds[kind]


class VectorSheet:
    """A sheet as a :class:`~geomsim.drawing.surface.Surface`, seven inches wide on paper.

    Parameters
    ----------
    width, height : int
        In the pixels of its strokes.
    page : str
        Background.
    """

    def __init__(self, width: int, height: int, page: str) -> None:
        from matplotlib.figure import Figure

        self._figure = Figure(figsize=(_INCHES, _INCHES * height / width), facecolor=page)
        self._axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0, width), ylim=(height, 0))
        self._axes.set_axis_off()
        self._point = _POINTS / width
        self._corner = np.zeros(2)
        self._order = [0.0]

    def save(self, path: Path) -> Path:
        """Write an ``.svg`` or ``.pdf``, without a date, whole or not at all; GeomsimError if it cannot be written."""
        import matplotlib

        kind = path.suffix[1:].lower()
        undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}[kind]
        # Text as outlines in SVG, as TrueType in PDF: neither needs a font where it is read.
        settings: Any = {"svg.hashsalt": "geomsim", "svg.fonttype": "path", "pdf.fonttype": 42}
        with replacing(path) as part, matplotlib.rc_context(settings):
            self._figure.savefig(part, format=kind, facecolor=self._figure.get_facecolor(), metadata=undated)
        return path

    def part(self, box: Box) -> Self:
        """Return the same sheet with another origin; nothing is cut off at the box."""
        shifted = object.__new__(type(self))
        shifted.__dict__.update(self.__dict__)
        shifted._corner = self._corner + np.array([box.left, box.top])
        return shifted

    def line(self, pixels: NDArray[np.float64], colour: str, width: float, *, closed: bool = False) -> None:
        """Draw a polyline."""
        from matplotlib.patches import Polygon

        self._add(
            Polygon(
                pixels + self._corner,
                closed=closed,
                fill=False,
                edgecolor=colour,
                linewidth=width * self._point,
                joinstyle="round",
                capstyle="round",
            )
        )

    def dashes(
        self, pixels: NDArray[np.float64], colour: str, width: float, *, dash: float, gap: float, shift: float = 0.0
    ) -> None:
        """Draw a polyline in dashes."""
        from matplotlib.patches import Polygon

        period = dash + gap
        pattern = (shift % period) * self._point, (dash * self._point, gap * self._point)
        thick = width * self._point
        self._add(
            Polygon(
                pixels + self._corner,
                closed=False,
                fill=False,
                edgecolor=colour,
                linewidth=thick,
                linestyle=(pattern[0] / thick, tuple(length / thick for length in pattern[1])),
                capstyle="butt",
            )
        )

    def dotted(self, paths: Sequence[NDArray[np.float64]], colour: str, width: float, spacing: float) -> None:
        """Draw polylines as rows of dots: dashes of no length with round ends."""
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path as Outline

        if paths:
            joined = Outline.make_compound_path(*(Outline(path + self._corner) for path in paths))
            pattern = (0.0, (0.0, spacing / width))
            thick = width * self._point
            self._add(
                PathPatch(joined, fill=False, edgecolor=colour, linewidth=thick, linestyle=pattern, capstyle="round")
            )

    def polygon(self, rings: Sequence[NDArray[np.float64]], colour: str, seam: float = 0.0) -> None:
        """Fill the area within rings, outer ones one way round and holes the other."""
        self._fill(rings, colour, 1.0, seam)

    def tint(self, pixels: NDArray[np.float64], colour: str, opacity: float) -> None:
        """Blend a colour over the area within one ring."""
        self._fill([pixels], colour, opacity)

    def disc(self, centre: NDArray[np.float64], radius: float, colour: str) -> None:
        """Fill a circle."""
        from matplotlib.patches import Circle

        x, y = np.asarray(centre) + self._corner
        self._add(Circle((float(x), float(y)), radius, facecolor=colour, linewidth=0))

    def strip(self, box: Box, colours: NDArray[np.uint8]) -> None:
        """Fill a box from left to right with colours."""
        left, top = self._corner
        extent = (box.left + left, box.right + left, box.bottom + top, box.top + top)
        limits = self._axes.axis()
        self._add(self._axes.imshow(colours[None], extent=extent, aspect="auto", interpolation="nearest"))
        self._axes.axis(limits)

    def text(
        self,
        text: str,
        at: tuple[float, float],
        size: float,
        colour: str,
        align: Align = "left",
        bold: bool = False,
    ) -> None:
        """Write a line of text."""
        x, y = np.asarray(at) + self._corner + np.array([0.0, 0.33 * size])
        side = "center" if align == "centre" else align
        weight = "bold" if bold else "normal"
        points = 0.9 * size * self._point
        told = self._axes.text(x, y, text, color=colour, fontsize=points, ha=side, va="baseline", fontweight=weight)
        self._raise(told)

    def _fill(self, rings: Sequence[NDArray[np.float64]], colour: str, opacity: float, seam: float = 0.0) -> None:
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path as Outline

        outlines = [Outline(np.vstack([ring, ring[:1]]) + self._corner, closed=True) for ring in rings]
        joined = Outline.make_compound_path(*outlines)
        self._add(PathPatch(joined, facecolor=colour, edgecolor=colour, alpha=opacity, linewidth=seam * self._point))

    def _add(self, artist: Artist) -> None:
        if artist.axes is None:
            self._axes.add_artist(artist)
        self._raise(artist)

    def _raise(self, artist: Artist) -> None:
        """Each stroke lies above those before it, whatever its kind."""
        self._order[0] += 1.0
        artist.set_zorder(self._order[0])
        artist.set_clip_on(False)
