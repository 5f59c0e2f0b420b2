"""Pictures of a chase."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geomsim.learning.chase import Chase

__all__ = ["frame"]


def frame(chase: Chase) -> NDArray[np.uint8]:
    """Draw this moment of a chase, shape (720, 1280, 3), red first."""
    from geomsim.drawing import draw_frame

    episode = chase.episode()
    return np.ascontiguousarray(draw_frame(episode, float(episode.times[-1]))[:, :, ::-1])
