"""Writers of small luminaire files, whose flux is known in closed form."""

import numpy as np

GAMMA = tuple(range(0, 181, 5))
LAMBERTIAN = tuple(max(np.cos(np.radians(g)), 0.0) for g in GAMMA)  # cd, of pi lm in an infinitely fine table


def ies(
    candela=LAMBERTIAN,
    vertical=GAMMA,
    horizontal=(0,),
    *,
    first="IESNA:LM-63-2002",
    keywords=("[TEST] none", "[MANUFAC] Ours", "[LUMINAIRE] Globe"),
    tilt="TILT=NONE",
    lamps=1,
    lumens: float = -1,
    multiplier: float = 1,
    kind=1,
    unit=2,
    size=(0, 0, 0),
    ballast: float = 1,
    second: float = 1,
    watts=10,
    ends="\n",
    between=" ",
) -> str:
    """Text of an IES file; ``candela`` has a row a horizontal angle, or one row for all."""
    table = np.atleast_2d(np.asarray(candela, float))
    table = np.broadcast_to(table, (len(horizontal), len(vertical)))
    numbers = [lamps, lumens, multiplier, len(vertical), len(horizontal), kind, unit, *size]
    rows = [numbers, [ballast, second, watts], vertical, horizontal, *table]
    lines = [*([first] if first else []), *keywords, tilt, *(between.join(f"{x:.9g}" for x in row) for row in rows)]
    return ends.join(lines) + ends


def ldt(
    intensity,
    planes,
    gamma=GAMMA,
    *,
    symmetry=0,
    sets=((1, 1000.0),),
    conversion=1.0,
    downward=0.0,
    efficiency=0.0,
    size=(0, 0, 0, 0, 0, 0),
    tilt=0.0,
    kind=3,
    comma=False,
    ends="\r\n",
) -> str:
    """Text of a EULUMDAT file; ``intensity`` has a row for each plane that the symmetry leaves, or one row for all."""
    count = {0: len(planes), 1: 1, 2: len(planes) // 2 + 1, 3: len(planes) // 2 + 1, 4: len(planes) // 4 + 1}[symmetry]
    table = np.broadcast_to(np.atleast_2d(np.asarray(intensity, float)), (count, len(gamma)))
    lamps = [line for n, lumens in sets for line in (n, "LED warm white", lumens, "3000", "80", "12,5")]
    lines = [
        *("Ours", kind, symmetry, len(planes), 0, len(gamma), 0, "report", "Leuchte für Büros", "7", "a.ldt", "today"),
        *(600, 600, 80, *size, downward, efficiency, conversion, tilt, len(sets), *lamps, *[0.5] * 10),
        *(*planes, *gamma, *(f"{x:.9g}" for x in table.ravel())),
    ]
    words = [str(line).replace(".", ",") if comma and not isinstance(line, str) else str(line) for line in lines]
    return ends.join(words) + ends
