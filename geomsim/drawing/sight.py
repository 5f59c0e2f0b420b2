"""What each pursuer of an episode catches: its line of sight, or its cell where the scenario says so."""

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from geomsim.drawing.moment import Moment
from geomsim.drawing.visibility import Walls
from geomsim.episode import Episode

__all__ = ["Sight", "eyes"]


class Sight:
    """The areas that pursuers see, with the sensor and the capture rule of the scenario.

    Parameters
    ----------
    episode : Episode
        The keys ``capture``, ``range`` and ``fov_degrees`` of its scenario count, the latter with one value for all
        robots or one each; a key that is not there means sight without that limit, as in a scenario file.
    """

    def __init__(self, episode: Episode) -> None:
        self._by_cell = episode.scenario.get("capture") == "cell"
        self._eyes = eyes(episode)
        self._cells = episode.cells.cells
        self._walls = Walls(episode.plan)

    def area(self, moment: Moment, pursuer: int) -> NDArray[np.float64]:
        """Return the outline of what a pursuer sees, shape (k, 2), metres."""
        if self._by_cell:
            return shapely.get_coordinates(self._cells[moment.cells[pursuer]].exterior)
        reach, field = self._eyes[pursuer]
        return self._walls.seen_from(moment.pursuers[pursuer], reach, float(moment.headings[pursuer]), field)


def eyes(episode: Episode) -> list[tuple[float, float]]:
    """Return the range (metres) and the field of view (radians) of every robot."""
    robots = episode.pursuers.shape[1]
    reach, field = (
        np.broadcast_to(np.array(episode.scenario.get(key, without), dtype=np.float64), robots).tolist()
        for key, without in (("range", math.inf), ("fov_degrees", 360.0))
    )
    return [(r, math.radians(f)) for r, f in zip(reach, field, strict=True)]
