"""The options of ``radiosity solve``, one dataclass a group. Those of methods come from the table in `method.options`."""

from dataclasses import dataclass, field, make_dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter

from ..errors import MethodError
from ..method.option import Option
from ..method.options import BASELINE, METHOD
from .options import Chosen, Count, DeviceName, Flag, Length, Outputs, Seconds, Seed, Share, Stops

RUN = Group("The run", sort_key=5)  # tuning options of methods are shown there, too
VALUES: dict[str, Any] = {"choice": str | None, "switch": bool | None, "flag": Chosen, "whole": Count, "share": Share}


@dataclass(frozen=True)
class Budget:
    """The budget: when to stop.

    Attributes:
        rays: Number of lines in all, such as 10M (the default), 500k or 1e7. Baselines run until they are done; progressive and
            hierarchical ones may end at this number.
        seconds: Time to trace, such as 60, 5min or 1h.
        error: Trace until the relative error is below this, such as 1% or 0.01. In 95 % of runs the true error then is. A
            number of lines or seconds beside it is a limit. A run that ends above the error, or with too few lines to tell, has
            the status "not reached" and the exit status 3. Without a limit it goes on until the error is reached, but only to
            4 billion lines a replicate where so many do not tell it.
        error_of: What --error is the error of: surface:NAME (RMS over its patches), or mean:NAME (its mean irradiance, the ± of
            the report). NAME may be a pattern. Default: RMS over all patches.
        importance: Share lines out for one result: surface:NAME (its mean irradiance; NAME may be a pattern), camera or camera:1
            (what the scene's first or second camera sees; they count from 0), or sensors (those of the scene's file). --error
            is then the error of this result, and other patches have larger ones (docs/importance.md). Default: all patches
            count.
        quanta: Reproduce a run: energy packets (quanta) of each replicate, as its report says.
    """

    rays: Count = None
    seconds: Seconds = None
    error: Share = None
    error_of: str | None = None
    importance: str | None = None
    quanta: Count = None

    @property
    def given(self) -> list[str]:
        """Options that say when to stop.

        Raises:
            MethodError: they exclude each other.
        """
        names = ("rays", "seconds", "error", "quanta")
        given = [f"--{name}" for name in names if getattr(self, name) is not None]
        if len(given) > 1 and (self.error is None or self.quanta is not None):
            raise MethodError(
                f"give one of --rays, --seconds, --error and --quanta, not {' and '.join(given)}; only --error goes with "
                "--rays or --seconds, as its limit"
            )
        return given


@dataclass(frozen=True)
class Size:
    """How large patches are.

    Attributes:
        patch_size: Longest edge of a patch, in metres. Default: about 20 000 patches in all; 2 000 for baselines.
        cells: Cut every face into CELLS x CELLS patches.
    """

    patch_size: Length = None
    cells: Count = None


@dataclass(frozen=True)
class Mesh(Size):
    """How faces are cut into patches, evenly or where light varies.

    Attributes:
        patches: At most so many patches, such as 50k, which follow the light: faces are cut where other faces touch them, and
            where light varies, as pilot runs see it (docs/meshes.md).
        adaptive: The same, with as many patches as by default.
        contacts: Cut faces along the outlines of what touches them or lies just in front of them, such as lamps below a ceiling;
            their parts have the size of --patch-size, or its default.
    """

    patches: Count = None
    adaptive: Flag = False
    contacts: Flag = False

    @property
    def follows(self) -> bool:
        """Patches follow the light."""
        return self.patches is not None or self.adaptive

    @property
    def sized(self) -> bool:
        """Patches have one size.

        Raises:
            MethodError: they are to follow the light as well.
        """
        sized = self.patch_size is not None or self.cells is not None
        if sized and self.follows:
            raise MethodError("--patches and --adaptive cut where light varies: leave out --patch-size and --cells")
        if self.contacts and (self.follows or self.cells is not None):
            raise MethodError(
                "--contacts cuts faces into parts of unlike size, as --patches and --adaptive do by themselves: leave it out, or "
                "leave out --cells, --patches and --adaptive"
            )
        return sized or self.contacts


@dataclass(frozen=True)
class Cut(Mesh):
    """How faces are cut into patches.

    Attributes:
        powers_of_two: Cut faces into 1, 2, 4, 8 ... cells along each edge. Hierarchical radiosity always does; with this option
            other methods have the same patches, to compare with it.
        refine_check: Solve on patches cut into four, too, and report sampling and discretisation errors apart. With a .csv
            output also as NAME.refine.csv.
    """

    powers_of_two: Flag = False
    refine_check: Flag = False

    @property
    def given(self) -> bool:
        """Patches are cut as these options say, and not as they come."""
        if self.powers_of_two and self.follows:
            raise MethodError("--patches and --adaptive cut where light varies: leave out --powers-of-two")
        return self.sized or self.powers_of_two or self.follows


@dataclass(frozen=True)
class Machine:
    """What every run has.

    Attributes:
        seed: Seed of all random numbers. Equal seeds give equal results.
        device: auto, cpu or cuda.
        memory: Memory limit, such as 8G or none. A run that needs more is refused before it begins. Default: 70 % of what is
            free.
    """

    seed: Seed = 0
    device: DeviceName = "auto"
    memory: str | None = None


@dataclass(frozen=True)
class Replicated(Machine):
    """What runs have whose errors come from replicates.

    Attributes:
        replicates: Number of independent randomised runs, from which errors are found.
    """

    replicates: Count = 8


@dataclass(frozen=True)
class Running(Machine):
    """What concerns the run.

    Attributes:
        replicates: Number of independent randomised runs, from which errors are found. Default: 8; 1 for baselines.
        resume: Continue from this .npz file of the same scene, method, seed and replicates, finished or interrupted. Its lines
            count. It reuses its patches unless you set others. Not for full-matrix. In several bands a finished run must have
            ended on a power of two of --quanta.
        checkpoint: An .npz file that keeps the state of the run, written about every 30 seconds, for --resume after a crash, a
            kill or a power cut. It is removed when all outputs are written. Default: for longer runs, beside the
            first output: out/box.glb -> out/box.checkpoint.npz.
        no_checkpoint: Write no checkpoint.
        cluster: Trace on the workers of Dask: tcp://HOST:PORT or tls://HOST:PORT of a scheduler, or local:N for N processes on
            this machine. The result has the same bits as without (docs/cluster.md).
    """

    replicates: Count = None
    resume: Path | None = None
    checkpoint: Path | None = None
    no_checkpoint: Flag = False
    cluster: str | None = None


@dataclass(frozen=True)
class Reading:
    """How the scene is read.

    Attributes:
        max_reflectance: Bring larger reflectances in files down to this. What your own .toml sets below 1 stays as it is.
        strict: Treat faults in the scene as errors, also those that could be skipped with a warning.
        allow_outside: Let the scene name files (includes, meshes, textures) outside its folder.
    """

    max_reflectance: float = 0.95
    strict: Flag = False
    allow_outside: Flag = False


@dataclass(frozen=True)
class Output:
    """What is written.

    Attributes:
        output: Files to write: .npz .glb .ply .vtp .csv .png .exr, several at once. Beside x.csv, a table of patches, goes
            x.surfaces.csv, a table of surfaces with their net power.
        exposure: Brightness of pictures and meshes, in stops above the automatic scale; +1 is twice.
    """

    output: Outputs = ()
    exposure: Stops = None


def _choices(name: str, options: dict[str, Option]) -> Any:
    """A dataclass of options of methods, in which None is what was not given. ``--method`` chooses a scheme."""

    def entry(option: Option):
        shown: dict[str, Any] = {"group": RUN} if option.tuning else {}
        return option.name, Annotated[VALUES[option.kind], Parameter(help=option.about, **shown)], field(default=None)

    entries = [entry(option) for option in options.values() if option.name != "scheme"]
    return make_dataclass(name, entries, frozen=True, namespace={"__module__": __name__})


class MethodChoices(_choices("MethodChoices", METHOD)):
    """Options of methods that trace lines."""


class BaselineChoices(_choices("BaselineChoices", BASELINE)):
    """Options of methods that form the matrix."""


METHODS = Group("The method", sort_key=2)
OutputOptions = Annotated[Output, Parameter(name="*")]
BudgetOptions = Annotated[
    Budget, Parameter(name="*", group=Group("How long to trace: one of these, or --error with a limit", sort_key=1))
]
MethodName = Annotated[str, Parameter(group=METHODS)]
MethodOptions = Annotated[MethodChoices, Parameter(name="*", group=METHODS)]
BaselineOptions = Annotated[
    BaselineChoices, Parameter(name="*", group=Group("Methods that form the matrix (baselines)", sort_key=3))
]
PATCHES = Group("Patches", sort_key=4)
CutOptions = Annotated[Cut, Parameter(name="*", group=PATCHES)]
RunOptions = Annotated[Running, Parameter(name="*", group=RUN)]
SceneOptions = Annotated[Reading, Parameter(name="*", group=Group("The scene", sort_key=6))]


class Unset:
    """Each group of options where none of them is given."""

    output, budget, cut, run, reading = Output(), Budget(), Cut(), Running(), Reading()
    method, baseline = MethodChoices(), BaselineChoices()
