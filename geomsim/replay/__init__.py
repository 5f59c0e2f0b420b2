"""A pursuit as one web page: play, pause, scrub, look into cells; no network, no server."""

from geomsim.replay.page import write_replay

__all__ = ["write_replay"]
