"""``radiosity convert``"""

from functools import partial
from pathlib import Path

from ..errors import OutputError, SceneError, printable
from . import outputs
from .options import Flag
from .solve_options import SceneOptions, Unset
from .streams import tell

SOLVED = "a scene holds no results; `radiosity solve` makes them"


def convert(
    source: str,
    /,
    *targets: Path,
    scene: Flag = False,
    reading: SceneOptions = Unset.reading,
) -> None:
    """Convert a scene or a solution to files of other formats.

    A scene becomes .toml (with its geometry beside it), .glb, .gltf, .obj (with an .mtl beside it), .ply, .stl, .rad (Radiance),
    .mgf, .xml (Mitsuba, with its meshes beside it), .hbjson (honeybee), .vs3 (View3D) or .ifc (with ifcopenshell, of the extra
    `ifc`); .toml holds most. A solution becomes what `radiosity solve -o` writes: .npz, .glb, .ply, .vtp, .csv, .png or .exr. A
    warning for each kind of thing that a format cannot hold names what it is.

    Parameters
    ----------
    source
        A scene file, a built-in scene, or an .npz file of `radiosity solve` or `radiosity lines`.
    targets
        Files to write, by their endings.
    scene
        Of a solution or of lines: write their scene, not their results. Endings that only scenes have need no such option.
    """
    from ..conversion.save import SUFFIXES as OF_SCENES
    from ..conversion.save import save_scene
    from ..image import SUFFIXES as OF_SOLUTIONS

    if not targets:
        raise OutputError("no output; name a file, such as `radiosity convert room.glb room.toml`")
    written = _check(source, targets)
    unknown = [path for path in targets if path.suffix.lower() not in (*OF_SCENES, *OF_SOLUTIONS)]
    if unknown:
        known = f"scenes: {', '.join(OF_SCENES)}; solutions: {', '.join(OF_SOLUTIONS)}"
        raise OutputError(f"{unknown[0]}: unknown output format '{unknown[0].suffix}'; known are those of {known}")
    solution, read = _read(source, reading, written)
    tasks = []
    for path in targets:
        suffix = path.suffix.lower()
        if suffix in OF_SCENES and (solution is None or scene or suffix not in OF_SOLUTIONS):
            tasks.append((path, partial(_written, path, partial(save_scene, read, path))))
        elif solution is None or scene:
            raise OutputError(f"{path}: {SOLVED if Path(source).suffix.lower() != '.npz' else OF_LINES}")
        else:
            outputs.check([path])
            tasks.append((path, partial(_written, path, partial(solution.export, path))))
    failures = outputs.attempt(tasks)
    if failures:
        raise OutputError("; ".join(outputs.told(failures)))


OF_LINES = (
    "this ending is of solutions, and the file is written as a scene: `radiosity relight` and `radiosity factors` make results "
    "of lines; leave --scene out for those of a solution"
)


def _check(source: str, targets) -> list[Path]:
    """Refuse a target that would be written twice, or that is the source, and return the files that may be written.

    Raises:
        OutputError: there is one.
    """
    from ..conversion.save import files_of as of_scene
    from ..image import files_of as of_solution

    seen, written = {Path(source).resolve(): f"{source} is read"}, []
    for path in targets:
        for file in dict.fromkeys((*of_scene(path), *of_solution(path))):
            if file.resolve() in seen:
                raise OutputError(
                    f"{path}: {printable(file)} would be written over ({seen[file.resolve()]}); choose another name"
                )
            seen[file.resolve()] = f"{path} writes it"
            written.append(file)
    return written


def _read(source: str, reading, written):
    """Return the solution of a file, or None, and its scene.

    Raises:
        OutputError: a file that it was read from is among those that may be written.
    """
    import radiosity as rd

    if Path(source).suffix.lower() != ".npz":
        return None, outputs.scene_of(source, reading, written)
    try:
        solution = rd.load_solution(source)
    except SceneError as error:
        if "line set" not in str(error):
            raise
        solution, scene = None, rd.load_lines(source).patches.scene
    else:
        scene = solution.patches.scene
    outputs.spare([scene.source], written)
    return solution, scene


def _written(path: Path, write) -> None:
    write()
    tell(f"wrote {printable(path)}")
