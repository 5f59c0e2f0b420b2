"""Belief, motion and capture models, cost heuristics, path search, coordination."""
