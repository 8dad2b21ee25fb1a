"""``radiosity experiment``"""

from pathlib import Path

from . import interrupts
from .options import Flag, Folder
from .streams import say


def experiment(which: str, /, *, quick: Flag = False, image: Flag = False, output: Folder = Path("out/experiments")) -> int:
    """Rerun the paper's experiments and write a report, figures and tables. An interrupted study goes on where it stopped.

    Parameters
    ----------
    which
        1 (sampling order), 2 (local and global lines), 3 (discrete, continuous, Keller), 4 (number generators), 5 (beyond the
        paper: bits and error bars), 6 (against the methods that form the matrix), or all.
    quick
        Up to 2^17 lines instead of 2^23: about two minutes for all.
    image
        Show the error of tone-mapped pictures too, as the paper does for its box.
    output
        The folder to write to: report.html, figures (.png, .svg), results.csv, .nc, and the series that are done.
    """
    from ..errors import MethodError
    from ..lab.experiments import EXPERIMENTS

    names = {str(number): number for number in EXPERIMENTS}
    if which != "all" and which not in names:
        raise MethodError(f"experiment '{which}' does not exist; known are {', '.join(names)} and all")
    numbers = list(EXPERIMENTS) if which == "all" else [names[which]]
    from ..lab.make import make
    from ..lab.study import FULL, QUICK
    from .progress import steps

    command = f"radiosity experiment {which}{' --quick' if quick else ''}{' --image' if image else ''}"
    try:
        with steps() as told:
            report = make(numbers, QUICK if quick else FULL, output, command, told, image=image)
    except KeyboardInterrupt:
        say("interrupted", f"the series that are done lie in {output / 'series'}; the same command goes on with the others")
        return interrupts.status()
    print(report)
    return 0
