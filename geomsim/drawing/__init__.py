"""Pictures of plans, cells and pursuits, drawn with OpenCV."""

from geomsim.drawing.frame import FrameDrawer, FrameStyle, draw_frame
from geomsim.drawing.theme import THEMES, DrawingError, Theme

__all__ = ["THEMES", "DrawingError", "FrameDrawer", "FrameStyle", "Theme", "draw_frame"]
