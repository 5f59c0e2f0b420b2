"""The legend: what the colours of cells mean, in numbers, and how long a metre is."""

import numpy as np

from geomsim.drawing.scale import ProbabilityScale, percent, round_number
from geomsim.drawing.strokes import Image, line
from geomsim.drawing.text import Align, draw_text
from geomsim.drawing.theme import Theme
from geomsim.drawing.viewport import Box

__all__ = ["draw_colour_bar", "draw_scale_bar"]


def draw_colour_bar(image: Image, box: Box, scale: ProbabilityScale, theme: Theme, unit: float, title: str) -> None:
    """Draw the ramp with the probabilities that five of its colours stand for.

    The bar is even in colour, so the numbers are those of the square-root scale: one quarter of the way up stands
    for a sixteenth of the top.
    """
    size = 12 * unit
    draw_text(image, title, (box.left, box.top + 8 * unit), size, theme.muted)
    top, bottom = round(box.top + 20 * unit), round(box.top + 33 * unit)
    columns = np.linspace(0, 255, box.width).round().astype(int)
    image[top:bottom, box.left : box.right] = theme.ramp[columns][:, ::-1]
    frame = np.array([[box.left, top], [box.right - 1, top], [box.right - 1, bottom - 1], [box.left, bottom - 1]])
    line(image, frame.astype(float), theme.grid, max(1, round(unit)), closed=True)
    for part in (0.0, 0.25, 0.5, 0.75, 1.0):
        x = box.left + part * (box.width - 1)
        line(image, np.array([[x, bottom], [x, bottom + 3 * unit]]), theme.muted, max(1, round(unit)))
        align: Align = "left" if part == 0 else "right" if part == 1 else "centre"
        draw_text(image, percent(scale.top * part**2), (x, bottom + 11 * unit), size, theme.muted, align)


def draw_scale_bar(image: Image, box: Box, metres_to_pixels: float, theme: Theme, unit: float) -> None:
    """Draw a round number of metres at the lower left of a box."""
    length = round_number(0.6 * box.width / metres_to_pixels, up=False)
    x, y = box.left, box.bottom - 8 * unit
    end = x + length * metres_to_pixels
    tick = 4 * unit
    bar = np.array([[x, y - tick], [x, y + tick], [x, y], [end, y], [end, y - tick], [end, y + tick]])
    line(image, bar, theme.text, max(1, round(1.6 * unit)))
    draw_text(image, f"{length:g} m", (end + 8 * unit, y), 12 * unit, theme.text)
