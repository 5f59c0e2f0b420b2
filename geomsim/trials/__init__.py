"""Many trials at once: a bank of evaders, one run of the team for each method, compiled sight, statistics."""
