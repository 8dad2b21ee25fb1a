"""``radiosity experiment``"""

from pathlib import Path

from . import interrupts
from .options import Flag, Folder
from .streams import say


def experiment(*which: str, quick: Flag = False, image: Flag = False, output: Folder = Path("out/experiments")) -> int:
    """Rerun the paper's experiments and write a report, figures and tables. An interrupted study goes on where it stopped.

    Parameters
    ----------
    which
        1 (sampling order), 2 (local and global lines), 3 (discrete, continuous, Keller), 4 (number generators), 5 (beyond the
        paper: bits and error bars), 6 (against the methods that form the matrix), 7 (linear and quadratic light), 8 (quadratures
        of global lines), 9 (continuous walks with sorted particles), several of them such as 1 3, or all.
    quick
        Up to 2^17 lines instead of 2^23: 1 to 6 take two to three minutes on 2 cores, in place of fifty.
    image
        Show the error of tone-mapped pictures too, as the paper does for its box.
    output
        The folder to write to: a report, figures (.png, .svg), a table, .nc, and the series that are done. The report of all
        is report.html, that of 1 3 --quick is report-1-3-quick.html, and the table is called alike: results-1-3-quick.csv.
    """
    from ..errors import MethodError
    from ..lab.experiments import EXPERIMENTS

    names = {str(number): number for number in EXPERIMENTS}
    known = f"known are {', '.join(names)} and all"
    if not which:
        raise MethodError(f"name an experiment, or several; {known}")
    for name in which:
        if name != "all" and name not in names:
            raise MethodError(f"experiment '{name}' does not exist; {known}")
    numbers = list(EXPERIMENTS) if "all" in which else sorted({names[name] for name in which})
    from ..lab.make import make
    from ..lab.study import FULL, QUICK
    from .progress import steps

    command = f"radiosity experiment {' '.join(which)}{' --quick' if quick else ''}{' --image' if image else ''}"
    try:
        with steps() as told:
            report = make(numbers, QUICK if quick else FULL, output, command, told, image=image)
    except KeyboardInterrupt:
        say("interrupted", f"the series that are done lie in {output / 'series'}; the same command goes on with the others")
        return interrupts.status()
    print(report)
    return 0
