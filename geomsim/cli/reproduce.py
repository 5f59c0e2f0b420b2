"""``geomsim reproduce``: the paper's experiments, as a page."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from geomsim.cli.compare import DaskFlag, WorkersFlag
from geomsim.cli.console import complain, say, say_json, tally
from geomsim.cli.flags import JsonFlag, OutFlag

__all__ = ["reproduce"]


def reproduce(
    *,
    trials: Annotated[int, Parameter(help="Evaders that each method searches for.")] = 1000,
    only: Annotated[str | None, Parameter(help="Experiments to run, with commas between them.")] = None,
    seed: Annotated[int, Parameter(help="The same seed gives the same numbers.")] = 0,
    workers: WorkersFlag = None,
    dask: DaskFlag = None,
    out: OutFlag = None,
    json: JsonFlag = False,
) -> int:
    """Run the experiments of the paper's Section V and write a page with its figures beside ours.

    Results are kept as they come: the same command goes on where it was interrupted.
    """
    from geomsim.files import output_folder
    from geomsim.trials import dask_executor
    from geomsim.trials.page import write_page
    from geomsim.trials.paper import parts
    from geomsim.trials.paper import reproduce as run
    from maps import GeomsimError, nearest

    known = [part.key for part in parts()]
    chosen = () if only is None else tuple(key.strip() for key in only.split(","))
    for key in chosen:
        if key not in known:
            raise GeomsimError(f"There is no experiment {key!r}: {nearest(key, known)}")
    folder = output_folder(out or Path("geomsim-output") / f"reproduction-{trials}-{seed}")
    try:
        with ExitStack() as stack:
            executor = None if dask is None else stack.enter_context(dask_executor(dask))
            bars = stack.enter_context(tally())
            result = run(
                folder, trials=trials, seed=seed, executor=executor, workers=workers, progress=bars, only=chosen
            )
    except KeyboardInterrupt:
        complain(f"Interrupted; what was finished is in {folder}, and the same command goes on from there.")
        return 130
    files = write_page(result, folder)
    if json:
        say_json(
            {
                "claims": [
                    {"what": c.what, "paper": c.paper, "ours": c.ours, "ratio": c.ratio, "agrees": c.agrees}
                    for c in result.claims
                ],
                "experiments": {key: trials.as_dict() for key, trials in result.trials.items()},
                "files": {kind: str(path) for kind, path in files.items()},
            }
        )
        return 0
    for claim in result.claims:
        say(f"{'agrees ' if claim.agrees else 'DIFFERS'}  {claim.what}: {claim.paper} in the paper, {claim.ours} here")
    for kind, path in files.items():
        say(f"{kind + ':':<10} {path}")
    return 0
