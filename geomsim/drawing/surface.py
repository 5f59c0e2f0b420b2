"""What a picture can be drawn on: pixels or vectors, with the same strokes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.viewport import Box

__all__ = ["Align", "Surface"]

Align = Literal["left", "centre", "right"]


class Surface(Protocol):
    """Strokes in pixels, x right and y down; colours are ``#rrggbb``, widths and sizes pixels."""

    def part(self, box: Box) -> Self:
        """Return the surface within a box, whose upper left corner becomes (0, 0)."""
        ...

    def line(self, pixels: NDArray[np.float64], colour: str, width: float, *, closed: bool = False) -> None:
        """Draw a polyline, shape (k, 2)."""
        ...

    def dashes(
        self, pixels: NDArray[np.float64], colour: str, width: float, *, dash: float, gap: float, shift: float = 0.0
    ) -> None:
        """Draw a polyline in dashes, of which ``shift`` pixels count as drawn already."""
        ...

    def dotted(self, paths: Sequence[NDArray[np.float64]], colour: str, width: float, spacing: float) -> None:
        """Draw polylines as rows of dots."""
        ...

    def polygon(self, rings: Sequence[NDArray[np.float64]], colour: str, seam: float = 0.0) -> None:
        """Fill the area within rings by the even-odd rule, and a line of width ``seam`` around it."""
        ...

    def tint(self, pixels: NDArray[np.float64], colour: str, opacity: float) -> None:
        """Blend a colour over the area within one ring."""
        ...

    def disc(self, centre: NDArray[np.float64], radius: float, colour: str) -> None:
        """Fill a circle."""
        ...

    def strip(self, box: Box, colours: NDArray[np.uint8]) -> None:
        """Fill a box from left to right with colours, shape (k, 3), red first."""
        ...

    def text(
        self,
        text: str,
        at: tuple[float, float],
        size: float,
        colour: str,
        align: Align = "left",
        bold: bool = False,
    ) -> None:
        """Write a line of text; ``at`` is halfway up a capital letter at the left end, middle or right end."""
        ...
