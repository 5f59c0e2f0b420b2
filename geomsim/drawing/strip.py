"""The strip below the plan: how the probability of capture grows, and when capture came."""

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.moment import Moment
from geomsim.drawing.scale import ticks
from geomsim.drawing.strokes import Image, disc, line, tint
from geomsim.drawing.text import draw_text, text_width
from geomsim.drawing.theme import Theme
from geomsim.drawing.viewport import Box
from geomsim.episode import Episode

__all__ = ["CaptureStrip"]


class CaptureStrip:
    """A chart of p0 over time.

    Parameters
    ----------
    episode : Episode
        Whose.
    box : Box
        Where in the image, numbers of the axes included.
    theme : Theme
        Colours.
    unit : float
        Pixels that a thin line takes.
    """

    def __init__(self, episode: Episode, box: Box, theme: Theme, unit: float) -> None:
        self._theme = theme
        self._unit = unit
        self._times = episode.belief_times
        self._values = episode.beliefs[:, 0]
        self._outcome = episode.outcome
        self._end = max(float(episode.times[-1]), 1e-9)
        size = 12.0 * unit
        left = text_width("100 %", size) + round(8 * unit)
        self._plot = box.inset(left, round(20 * unit), round(52 * unit), round(20 * unit))

    def draw_axes(self, image: Image) -> None:
        """Draw what does not change."""
        theme, unit, plot = self._theme, self._unit, self._plot
        thin = max(1, round(unit))
        title = "chance of capture by now, as the belief predicts"
        draw_text(image, title, (plot.left, plot.top - 11 * unit), 12 * unit, theme.muted)
        for value in (0.0, 0.5, 1.0):
            ends = self._at(np.array([0.0, self._end]), np.full(2, value))
            line(image, ends, theme.grid, thin)
            at = (plot.left - 7 * unit, float(ends[0, 1]))
            draw_text(image, f"{100 * value:.0f} %", at, 12 * unit, theme.muted, "right")
        for time in ticks(self._end, max(2, int(plot.width / (110 * unit)))):
            x, y = self._at(np.array([time]), np.zeros(1))[0]
            line(image, np.array([[x, y], [x, y + 4 * unit]]), theme.muted, thin)
            draw_text(image, f"{time:g} s", (x, y + 12 * unit), 12 * unit, theme.muted, "centre")

    def draw(self, image: Image, moment: Moment) -> None:
        """Draw the curve up to a moment, and the capture once it has come."""
        theme, unit = self._theme, self._unit
        count = moment.step + 1
        now = float(np.interp(moment.time, self._times, self._values))
        curve = self._at(np.append(self._times[:count], moment.time), np.append(self._values[:count], now))
        foot = self._at(np.array([moment.time, 0.0]), np.zeros(2))
        tint(image, np.vstack([curve, foot]), theme.curve, 0.22)
        line(image, curve, theme.curve, max(1, round(2 * unit)))
        tip = curve[-1]
        if moment.captured:
            bottom, top = self._at(np.full(2, self._outcome.time), np.array([0.0, 1.0]))
            line(image, np.stack([bottom, top]), theme.evader, max(1, round(1.6 * unit)))
            diamond = tip + 6 * unit * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
            tint(image, diamond, theme.evader, 1.0)
        else:
            disc(image, tip, 3.6 * unit, theme.curve)
        at = (float(tip[0]) + 9 * unit, float(tip[1]))
        draw_text(image, f"{100 * now:.0f} %", at, 13 * unit, theme.text, bold=True)

    def _at(self, times: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
        plot = self._plot
        x = plot.left + times / self._end * plot.width
        return np.stack([x, plot.bottom - values * plot.height], axis=-1)
