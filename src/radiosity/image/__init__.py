"""Files and pictures of solutions. A new file format is one new module with ``write(solution, path, look)`` and one line here."""

from importlib import import_module
from pathlib import Path

from ..errors import OutputError
from . import still
from .look import Look
from .output import check_writable as _check
from .output import require, require_results
from .render import render

FORMATS = {
    ".glb": "gltf",
    ".ply": "ply",
    ".vtp": "vtp",
    ".csv": "tables",
}
PICTURES = (".png", ".exr")
SUFFIXES = (".npz", *FORMATS, *PICTURES)  # a solution saves itself as .npz

__all__ = ["Look", "check_writable", "export", "files_of", "render"]


def check_writable(path) -> Path:
    """Find out before a run whether a result can be written to ``path``.

    Raises:
        OutputError: the suffix is unknown, the folder is missing or read-only, there is a folder or a read-only file of that
            name, or a library is not installed.
    """
    for file in files_of(path):
        _check(file, SUFFIXES)
    path = Path(path)
    if path.suffix.lower() == ".png":
        require("PIL", f"{path}: writing PNG")
    return path


def files_of(path) -> tuple[Path, ...]:
    """Return the files that `export` writes for a path: itself, and beside ``x.csv`` the table of surfaces."""
    path = Path(path)
    if path.suffix.lower() != ".csv":
        return (path,)
    from .tables import surfaces_path

    return path, surfaces_path(path)


def export(
    solution,
    path,
    *,
    smooth=True,
    quantity="radiosity",
    band=None,
    exposure=None,
    scale=None,
    final_gather=None,
    denoise=False,
    tone_map="clip",
    seed=0,
    progress=None,
) -> Path:
    """Write a solution in the format that the suffix names.

    .glb, .ply: coloured meshes. .vtp: mesh with all quantities. .csv: all quantities of the patches, and beside it
    ``x.surfaces.csv`` of the surfaces. .png, .exr: a picture, as `render` takes by default. .npz: ``solution.save``.

    Args:
        solution: to write.
        path: of the file, which appears whole or not at all.
        smooth: values are smoothed within surfaces where the format has colours; otherwise one value a patch.
        quantity, band, exposure, scale: of the colours, see `radiosity.image.look.Look`; .vtp, .csv and .npz hold everything.
        final_gather, denoise, tone_map, seed, progress: of pictures, see `radiosity.image.render`.

    Returns:
        The path.

    Raises:
        OutputError: the file cannot be written, or an option makes no sense.
    """
    path = check_writable(path)
    look, suffix = Look(quantity, band, smooth, exposure, scale), path.suffix.lower()
    if suffix in PICTURES:
        of_pictures = {"final_gather": final_gather, "denoise": denoise, "tone_map": tone_map}
        still.write(solution, path, look, **of_pictures, seed=seed, progress=progress)
        return path
    if final_gather is not None:
        raise OutputError(f"{path}: a final gather is of pictures ({', '.join(PICTURES)}); leave it out")
    if denoise or tone_map != "clip":
        raise OutputError(f"{path}: denoise and tone_map are of pictures ({', '.join(PICTURES)}); leave them out")
    if suffix == ".npz":
        solution.save(path)
    else:
        require_results(solution)
        module = import_module(f".{FORMATS[suffix]}", __package__)
        module.write(solution, path, look)
    return path
