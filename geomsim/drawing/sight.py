"""What each pursuer of an episode catches: its line of sight, or its cell where the scenario says so."""

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from geomsim.drawing.moment import Moment
from geomsim.drawing.visibility import Walls
from geomsim.episode import Episode

__all__ = ["Sight"]


class Sight:
    """The areas that pursuers see, with the sensor and the capture rule of the scenario.

    Parameters
    ----------
    episode : Episode
        The keys ``capture``, ``range`` and ``fov_degrees`` of its scenario count; a key that is not there means
        sight without that limit, as in a scenario file.
    """

    def __init__(self, episode: Episode) -> None:
        told = episode.scenario
        self._by_cell = told.get("capture") == "cell"
        self._range = float(told.get("range", math.inf))
        self._field = math.radians(float(told.get("fov_degrees", 360.0)))
        self._cells = episode.cells.cells
        self._walls = Walls(episode.plan)

    def area(self, moment: Moment, pursuer: int) -> NDArray[np.float64]:
        """Return the outline of what a pursuer sees, shape (k, 2), metres."""
        if self._by_cell:
            return shapely.get_coordinates(self._cells[moment.cells[pursuer]].exterior)
        return self._walls.seen_from(
            moment.pursuers[pursuer], self._range, float(moment.headings[pursuer]), self._field
        )
