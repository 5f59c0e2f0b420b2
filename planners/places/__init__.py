"""A belief over places on checkpoint routes, on which the evader's motion is Markov and sight is a matrix."""

from planners.places.keeping import cache_folder
from planners.places.placing import PlaceError, Places
from planners.places.sights import sight_of_places
from planners.places.walking import StandingStill, Strolling

__all__ = ["PlaceError", "Places", "StandingStill", "Strolling", "cache_folder", "sight_of_places"]
