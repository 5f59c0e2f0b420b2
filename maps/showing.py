"""A tiny SVG writer, so that plans and cell maps show themselves in a notebook without anything that draws."""

from collections.abc import Sequence

import shapely

__all__ = ["svg_picture"]

_WIDE, _HIGH = 720.0, 540.0


def svg_picture(shapes: Sequence[tuple[shapely.Geometry, str]], bounds: tuple[float, float, float, float]) -> str:
    """Return areas and lines as an SVG picture that fits a page.

    Parameters
    ----------
    shapes : sequence of (geometry, str)
        What to draw, the lowest first, in metres with y up, and its SVG attributes; strokes keep their width in
        pixels.
    bounds : tuple of float
        Smallest x and y, largest x and y of the picture, metres.
    """
    x0, y0, x1, y1 = bounds
    margin = 0.02 * max(x1 - x0, y1 - y0)
    width, height = x1 - x0 + 2 * margin, y1 - y0 + 2 * margin
    scale = min(_WIDE / width, _HIGH / height)
    left, top = margin - x0, margin + y1

    def outline(points: shapely.Geometry) -> str:
        steps = [f"{scale * (left + x):.2f} {scale * (top - y):.2f}" for x, y in shapely.get_coordinates(points)]
        return "M" + "L".join(steps)

    paths = []
    for shape, attributes in shapes:
        parts = shapely.get_parts(shape)
        lines = [ring for part in parts for ring in (shapely.get_rings(part) if part.area else [part])]
        drawn = "".join(outline(line) for line in lines)
        paths.append(f'<path fill-rule="evenodd" stroke-linejoin="round" {attributes} d="{drawn}"/>')
    size = f'width="{scale * width:.0f}" height="{scale * height:.0f}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img">{"".join(paths)}</svg>'
