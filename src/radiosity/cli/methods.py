"""``radiosity methods``"""

UNKNOWN = "The errors of baselines are unknown: they are those of form factors and meshes, which replicates cannot measure"


def methods(name: str | None = None, /) -> int:
    """List the methods, or say what one is, when to take it, its parameters and whom to cite.

    Parameters
    ----------
    name
        Of a method, or of one of the four axes: equation, lines, order, numbers; or of another choice, such as scrambling.
    """
    from ..errors import MethodError
    from ..method import BASELINES, PRESETS
    from ..method.auto import ABOUT as ABOUT_AUTO
    from ..method.auto import NAME as AUTO
    from ..method.options import BASELINE, METHOD

    known = PRESETS | BASELINES
    names = [AUTO, *known]
    axes = [option.name for option in (METHOD | BASELINE).values() if option.kind == "choice"]
    if name is None:
        _list()
    elif name in axes:
        _axis(name)
    elif name in known:
        _explain(name)
    elif name == AUTO:
        print(ABOUT_AUTO)
    else:
        raise MethodError(f"method '{name}' does not exist; known are {', '.join(names)}; and the axes {', '.join(axes)}")
    return 0


def _list() -> None:
    from rich.console import Console
    from rich.table import Table

    from ..method import BASELINES, PRESETS
    from ..method.auto import ABOUT
    from ..method.model import AXES

    table = Table(box=None, pad_edge=False)
    for head in ("method", *AXES, "more", "from"):
        table.add_column(head, no_wrap=True)
    for name, preset in PRESETS.items():
        axes = [getattr(preset.method, axis) for axis in AXES]
        more = ", ".join(str(preset.method).split("/")[len(AXES) :])
        fields = dict(preset.source.fields)
        table.add_row(name, *axes, more, f"{_family(fields['author'])} {fields['year']}")
    console = Console(highlight=False, width=1000)
    console.print(table)
    print(f"\n{ABOUT}")
    print("\nBaselines, which form the matrix (docs/baselines.md):")
    table = Table(box=None, pad_edge=False)
    for head in ("method", "scheme", "choices", "from"):
        table.add_column(head, no_wrap=True)
    for name, preset in BASELINES.items():
        scheme, *choices = str(preset.method).split("/")
        fields = dict(preset.source.fields)
        table.add_row(name, scheme, ", ".join(choices), f"{_family(fields['author'])} {fields['year']}")
    console.print(table)
    print(f"{UNKNOWN}.")
    print("\n`radiosity methods NAME` explains one; `radiosity methods numbers` (equation, lines, order) the choices of an axis,")
    print("which replace a method's own: radiosity solve room --method particle-tracing --numbers sobol")


def _family(authors: str) -> str:
    names = [author.split()[-1] for author in _plain(authors).split(" and ")]
    return f"{names[0]} et al." if len(names) > 2 else " and ".join(names)


def _plain(text: str) -> str:
    import re

    text = re.sub(r"{\\'a}", "á", text)
    return re.sub(r"{\\v{s}}", "š", text)


def _axis(axis: str) -> None:
    from ..method.options import BASELINE, METHOD

    values = (METHOD | BASELINE)[axis].values
    width = max(map(len, values))
    for value, text in values.items():
        print(f"{value:<{width}}  {_numbers(value) if axis == 'numbers' else text}")


def _numbers(name: str) -> str:
    from importlib import import_module

    from ..sampling.numbers import NUMBERS, SCRAMBLED, parts_of

    module = import_module(f"radiosity.sampling.numbers.{NUMBERS[name].split(':')[0]}")
    text = " ".join((module.__doc__ or "").split("\n\n")[0].split())
    sequence, scrambling = parts_of(name)
    return f"{text} The same as --numbers {sequence} --scrambling {scrambling}." if name in SCRAMBLED else text


def _explain(name: str) -> None:
    import textwrap

    from ..method import BASELINES, PRESETS

    preset = (PRESETS | BASELINES)[name]
    print(f"{name}: {preset.method}\n")
    for text in (preset.about, f"When: {preset.when}"):
        print(textwrap.fill(text, 100) + "\n")
    if preset.parameters:
        axes = "" if name in BASELINES else ", besides equation, lines, order, numbers, scrambling and randomisation"
        print(f"Its own parameters{axes}:")
        for parameter, meaning in preset.parameters:
            print(f"  {parameter:<16} {meaning}")
        print()
    if name in BASELINES:
        print(f"{UNKNOWN}.\n")
    print(preset.source.bibtex)
