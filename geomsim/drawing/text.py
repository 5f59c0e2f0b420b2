"""Text: OpenCV 5 draws real type, OpenCV 4 only strokes; both are measured before they are placed."""

from functools import cache
from typing import Any, Literal

import cv2

from geomsim.drawing.colours import bgr
from geomsim.drawing.strokes import Image

__all__ = ["Align", "draw_text", "text_width"]

Align = Literal["left", "centre", "right"]

# The stroke font of OpenCV 4 knows ASCII only.
_ASCII = str.maketrans({"·": "-", "\u2013": "-", "\u00d7": "x", "²": "2"})


def draw_text(
    image: Image,
    text: str,
    at: tuple[float, float],
    size: float,
    colour: str,
    align: Align = "left",
    bold: bool = False,
) -> None:
    """Draw a line of text.

    Parameters
    ----------
    image : ndarray of uint8, shape (height, width, 3)
        Drawn on.
    text : str
        What.
    at : tuple of float
        Pixel of the left end, middle or right end of the line, halfway up a capital letter.
    size : float
        Height of the type, pixels.
    colour : str
        ``#rrggbb``.
    align : str
        Which part of the line is at ``at``.
    bold : bool
        Heavier type.
    """
    x = at[0] - text_width(text, size, bold) * {"left": 0.0, "centre": 0.5, "right": 1.0}[align]
    origin = (round(x), round(at[1] + 0.36 * size))
    face = _face()
    if face is not None:
        cv2.putText(image, text, origin, bgr(colour), face, round(size), 600 if bold else 400)
    else:
        scale, width = _strokes(size, bold)
        font = cv2.FONT_HERSHEY_SIMPLEX
        cv2.putText(image, text.translate(_ASCII), origin, font, scale, bgr(colour), width, cv2.LINE_AA)


@cache
def text_width(text: str, size: float, bold: bool = False) -> int:
    """Return how many pixels wide a line of text will be."""
    face = _face()
    if face is not None:
        x, _, width, _ = cv2.getTextSize((1, 1), text, (0, 0), face, round(size), 600 if bold else 400)
        return int(x + width)
    scale, thickness = _strokes(size, bold)
    (width, _), _ = cv2.getTextSize(text.translate(_ASCII), cv2.FONT_HERSHEY_SIMPLEX, scale, thickness)
    return int(width)


@cache
def _face() -> Any | None:
    """Return the built-in typeface, None before OpenCV 5."""
    return cv2.FontFace("sans") if hasattr(cv2, "FontFace") else None


def _strokes(size: float, bold: bool) -> tuple[float, int]:
    # A capital letter of the stroke font is 21 units high at scale 1, of real type 0.72 of its size.
    return 0.72 * size / 21, max(1, round(size / (9 if bold else 16)))
