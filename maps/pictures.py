"""Image files as arrays, read whole or refused."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from maps.errors import PlanError

__all__ = ["MOST_PIXELS", "read_picture"]

MOST_PIXELS = 100_000_000


def read_picture(path: Path, where: str) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Read an image.

    Parameters
    ----------
    path : Path
        PNG, PGM, BMP, TIFF, JPEG or whatever else OpenCV reads.
    where : str
        What error sentences begin with.

    Returns
    -------
    brightness : ndarray, shape (H, W)
        Mean of the colours, 0 black to 1 white.
    opaque : ndarray of bool, shape (H, W)
        False where an alpha channel makes the image transparent.

    Raises
    ------
    PlanError
        If the file is missing, is no image, is cut short or is too large.
    """
    try:
        data = path.read_bytes()
    except OSError as exc:
        raise PlanError(f"{where}: the image {path} cannot be read ({exc.strerror}).") from exc
    if not _complete(data):
        raise PlanError(f"{where}: the image {path} is corrupt; its end is missing.")
    pixels = _decode(data)
    if pixels is None:
        raise PlanError(f"{where}: {path} is not an image that can be read.")
    if pixels.shape[0] * pixels.shape[1] > MOST_PIXELS:
        height, width = pixels.shape[:2]
        raise PlanError(f"{where}: the image {path} has {width} x {height} pixels; at most {MOST_PIXELS} are possible.")
    scale = float(np.iinfo(pixels.dtype.name).max) if np.issubdtype(pixels.dtype, np.integer) else 1.0
    layers = np.atleast_3d(pixels)
    colours = layers.shape[2] - (layers.shape[2] in (2, 4))
    opaque = layers[:, :, -1] > scale / 2 if colours < layers.shape[2] else np.ones(layers.shape[:2], dtype=np.bool_)
    return layers[:, :, :colours].mean(axis=2) / scale, opaque


def _decode(data: bytes) -> NDArray[np.integer | np.floating] | None:
    """Decode an image as it is stored; OpenCV's own complaints about broken files are not for the user."""
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
    except cv2.error:
        return None
    finally:
        cv2.utils.logging.setLogLevel(level)


def _complete(data: bytes) -> bool:
    """Whether a file has its end; OpenCV fills in what is missing of a PNG or a PGM with black."""
    if data.startswith(b"\x89PNG"):
        return b"IEND" in data[-16:]
    if data[:2] in (b"P5", b"P6"):
        header = [field for line in data[:1024].split(b"\n") for field in line.split(b"#")[0].split()][1:4]
        if len(header) < 3 or not all(field.isdigit() for field in header):
            return False
        width, height, largest = (int(field) for field in header)
        return len(data) >= width * height * (3 if data[1:2] == b"6" else 1) * (2 if largest > 255 else 1)
    return True
