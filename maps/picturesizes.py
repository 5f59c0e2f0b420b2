"""How large a picture is, from its first bytes, so that nobody need decode a giant to learn that it is one."""

from __future__ import annotations

import re
import struct

__all__ = ["picture_size"]

# Netpbm: "P5", then width and height between white space and comments.
_NETPBM = re.compile(rb"P[1-6]" + 2 * rb"(?:\s|#[^\n]*\n)+(\d{1,9})" + rb"(?=\s)")

# JPEG: the frame headers, SOF0 to SOF15 without DHT, JPG and DAC.
_FRAMES = set(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}


def picture_size(data: bytes) -> tuple[int, int] | None:
    """Width and height that a PNG, Netpbm, BMP, JPEG or TIFF file states; None where none can be found.

    Parameters
    ----------
    data : bytes
        The file.
    """
    try:
        if data.startswith(b"\x89PNG"):
            if data[12:16] != b"IHDR":
                return None
            return _pair(">II", data, 16)
        if data.startswith(b"BM"):
            width, height = _pair("<ii", data, 18)
            return abs(width), abs(height)
        if data.startswith(b"\xff\xd8"):
            return _jpeg(data)
        if data[:4] in (b"II*\0", b"MM\0*"):
            return _tiff(data, "<" if data[:1] == b"I" else ">")
    except (struct.error, KeyError):
        return None
    netpbm = _NETPBM.match(data[:4096])
    return (int(netpbm[1]), int(netpbm[2])) if netpbm else None


def _pair(form: str, data: bytes, at: int) -> tuple[int, int]:
    first, second = struct.unpack_from(form, data, at)
    return first, second


def _jpeg(data: bytes) -> tuple[int, int]:
    """Go from segment to segment until the header of the frame; struct.error where the file ends before."""
    at = 2
    while True:
        marker, length = _pair(">HH", data, at)
        if marker & 0xFF in _FRAMES:
            height, width = _pair(">HH", data, at + 5)
            return width, height
        at += 2 + length


def _tiff(data: bytes, order: str) -> tuple[int, int]:
    """Look tags 256 and 257 up in the first directory; KeyError where it lacks them."""
    (directory,) = struct.unpack_from(order + "I", data, 4)
    (count,) = struct.unpack_from(order + "H", data, directory)
    found = {}
    for k in range(count):
        tag, kind = _pair(order + "HH", data, directory + 2 + 12 * k)
        form = "H" if kind == 3 else "I"
        (found[tag],) = struct.unpack_from(order + form, data, directory + 10 + 12 * k)
    return found[256], found[257]
