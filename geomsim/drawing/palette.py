"""A palette of 256 colours for pictures that may have no more, as those of a GIF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.strokes import Image

__all__ = ["Palette"]

# Colours are told apart by the first five bits of each channel.
_BITS = 5


@dataclass(frozen=True, slots=True)
class Palette:
    """The colours that a film of flat areas uses most, and the nearest of them for every colour.

    Attributes
    ----------
    argb : ndarray of uint8, shape (256, 4)
        Opacity, red, green and blue.
    lookup : ndarray of uint8, shape (32768,)
        Index of the nearest colour by the first five bits of blue, green and red.
    """

    argb: NDArray[np.uint8]
    lookup: NDArray[np.uint8]

    @classmethod
    def of(cls, images: Sequence[Image]) -> Palette:
        """Choose the palette from some of the pictures."""
        pixels = np.concatenate([image.reshape(-1, 3) for image in images])
        bins = _bins(pixels)
        count = np.bincount(bins, minlength=1 << 3 * _BITS)
        means = np.stack(
            [np.bincount(bins, weights=pixels[:, k], minlength=len(count)) / np.maximum(count, 1) for k in range(3)],
            axis=1,
        )
        chosen = np.argsort(-count, kind="stable")[:256]
        chosen = chosen[count[chosen] > 0]
        colours = np.zeros((256, 3))
        colours[: len(chosen)] = means[chosen]
        levels = (np.arange(1 << _BITS) + 0.5) * (256 >> _BITS)
        centres = np.stack(np.meshgrid(levels, levels, levels, indexing="ij"), axis=-1).reshape(-1, 3)
        known = np.where(count[:, None] > 0, means, centres)
        palette = colours[: len(chosen)]
        # |a - b|^2 without the term that is the same for every palette colour.
        gap = (palette**2).sum(axis=1) - 2.0 * known @ palette.T
        argb = np.full((256, 4), 255, dtype=np.uint8)
        argb[:, 1:] = np.rint(colours[:, ::-1])
        return cls(argb, np.argmin(gap, axis=1).astype(np.uint8))

    def indices(self, image: Image) -> NDArray[np.uint8]:
        """Return the palette index of each pixel, shape (height, width)."""
        return self.lookup[_bins(image)]


def _bins(pixels: Image) -> NDArray[np.intp]:
    first = (pixels >> (8 - _BITS)).astype(np.intp)
    found: NDArray[np.intp] = (first[..., 0] << 2 * _BITS) | (first[..., 1] << _BITS) | first[..., 2]
    return found
