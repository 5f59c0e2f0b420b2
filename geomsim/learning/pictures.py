"""Pictures of a hunt."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geomsim.learning.hunt import Hunt

__all__ = ["frame"]


def frame(hunt: Hunt) -> NDArray[np.uint8]:
    """Draw this moment of a hunt, shape (720, 1280, 3), red first."""
    from geomsim.drawing import draw_frame

    episode = hunt.episode()
    return np.ascontiguousarray(draw_frame(episode, float(episode.times[-1]))[:, :, ::-1])
