"""``python -m geomsim``: the same as the command ``geomsim``."""

from geomsim.cli import main

if __name__ == "__main__":
    main()
