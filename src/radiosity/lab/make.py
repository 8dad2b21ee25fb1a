"""Making the files of experiments: figures, tables, and the report."""

from pathlib import Path

from ..errors import OutputError
from ..image.output import require
from . import figures, kept, pictures, report, store
from .experiments import EXPERIMENTS, module
from .results import Results
from .run import Told, run
from .study import QUICK, Protocol


def make(numbers: list[int], protocol: Protocol, folder: Path, command: str, told: Told, *, image: bool = False) -> Path:
    """Run experiments, write everything into a folder, and return the path of the report.

    Args:
        image: figures show the error of tone-mapped pictures too.

    Raises:
        OutputError: the folder cannot be written, or a library is missing.
    """
    for module_name in ("matplotlib", "xarray"):
        require(module_name, "the study")
    _writable(folder)
    tag = _tag(numbers, protocol)
    told("pictures of the scenes", 0, 1)
    pictures.scenes(folder / "scenes", protocol)
    caption = "<p>The scenes (the paper's figure 3): the room, and the maze of mean reflectance 0.9 from above.</p>"
    sections, found = [report.picture(folder / "scenes"), caption], {}
    for number in numbers:
        experiment, parts = module(number), []
        if hasattr(experiment, "SCENES"):
            series = folder / "series"
            results = run(number, protocol, series, lambda what, done, total, n=number: told(f"{n}: {what}", done, total))
            found[number] = results, {arm.name: str(arm.method) for arm in experiment.ARMS}
            parts += _drawn(experiment, number, results, folder, image)
            parts.append(report.findings(results, experiment.claims(results)))
            store.write_netcdf(folder / f"experiment-{number}.nc", results, {"command": command, "versions": report.versions()})
        if hasattr(experiment, "extras"):
            told(f"{number}: more", 0, 1)
            own = experiment.extras
            parts += own(protocol, folder) if number in found else kept.parts(number, own, protocol, folder)
        sections.append(report.section(number, experiment.TITLE, experiment.QUESTION, parts))
    store.write_csv(folder / f"results{tag}.csv", found)
    path = folder / f"report{tag}.html"
    path.write_text(report.page(sections, command, protocol), encoding="utf-8")
    return path


def _tag(numbers: list[int], protocol: Protocol) -> str:
    """Return a tag such as ``-1-3-quick`` for the names of files, so that commands keep their files apart; none for the whole
    study in full."""
    which = "" if list(numbers) == list(EXPERIMENTS) else "".join(f"-{number}" for number in numbers)
    return which + ("-quick" if protocol == QUICK else "")


def _drawn(experiment, number: int, results: Results, folder: Path, image: bool) -> list[str]:
    """Draw the figures of an experiment; return them for the report."""
    kinds = {"": {}}
    if getattr(experiment, "AGAINST_TIME", False):
        kinds["-time"] = {"seconds": True}
    if image:
        kinds["-picture"] = {"picture": True}
    pages = []
    for suffix, options in kinds.items():
        path = folder / f"experiment-{number}{suffix}"
        figures.convergence(results, experiment.ARMS, experiment.SCENES, experiment.TITLE, path, **options)
        pages.append(report.figure(path))
    return pages


def _writable(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / ".writable").touch()
        (folder / ".writable").unlink()
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written ({error.strerror})") from None
