from hypothesis import settings

# A loaded machine is no failure: nothing here is a test of speed.
settings.register_profile("maps", deadline=None)
settings.load_profile("maps")
