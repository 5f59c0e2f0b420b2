"""Pictures of plans, cells and pursuits, drawn with OpenCV."""

from geomsim.drawing.cellpicture import draw_cells, write_cells_picture
from geomsim.drawing.frame import FrameDrawer, FrameStyle, draw_frame
from geomsim.drawing.playback import write_frames
from geomsim.drawing.theme import THEMES, DrawingError, Theme

__all__ = [
    "THEMES",
    "DrawingError",
    "FrameDrawer",
    "FrameStyle",
    "Theme",
    "draw_cells",
    "draw_frame",
    "write_cells_picture",
    "write_frames",
]
