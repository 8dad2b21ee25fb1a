"""Global lines: uniform and isotropic through a ball about the scene, whatever the scene holds (Sbert 1993).

Each function returns a point of the line and its unit direction, in coordinates whose origin is the ball's centre. Of lines of
the first two kinds, a share of A / (2 pi R^2) crosses a plane element of area A; of those of a bundle, A / (8 R^2), since its
lattice covers the square about the disc. The mean over directions of A |cos| is A / 2, and a lattice of n lines has n / (4 R^2)
lines a unit of area.
"""

import drjit as dr

from .hemisphere import turn


def on_sphere(first, second):
    """Return a uniform point of the unit sphere: heights are uniform (Archimedes), and so is the angle about the axis."""
    z = dr.fma(-2, first, 1)
    radius = dr.sqrt(dr.maximum(dr.fma(-z, z, 1), 0))
    x, y = turn(second)
    return x * radius, y * radius, z


def by_two_points(numbers, radius, Array3f):
    """Return the line through two points, each uniform on the sphere of this radius (Sbert 1993)."""
    one, two = Array3f(*on_sphere(numbers[0], numbers[1])), Array3f(*on_sphere(numbers[2], numbers[3]))
    between = two - one
    length = dr.norm(between)
    # two equal points give no line: any direction is taken, and the line at the sphere's rim meets nothing
    return one * radius, dr.select(length > 0, between / length, Array3f(0, 0, 1))


def by_disc(numbers, radius, Array3f):
    """Return a uniform direction, and a uniform point of the disc across it, by concentric circles of equal area."""
    direction = Array3f(*on_sphere(numbers[0], numbers[1]))
    x, y = turn(numbers[2])
    distance = dr.sqrt(numbers[3]) * radius
    return across(direction, x * distance, y * distance), direction


def of_bundle(numbers, cell, side_bits: int, radius, Array3f):
    """Return one of the 4^side_bits parallel lines of a bundle.

    Args:
        numbers: of the bundle: two give its direction, two move its lattice by less than a step.
        cell: UInt32, number of the line; cells follow a Z-shaped curve (Morton 1966), so that neighbours in number are
            neighbours in space and packets of rays stay together.
        side_bits: the lattice has 2^side_bits lines along each edge of the square about the disc.
    """
    direction = Array3f(*on_sphere(numbers[0], numbers[1]))
    Float = type(radius)
    step = radius * (2.0 / 2**side_bits)
    u = dr.fma(Float(_every_other_bit(cell)) + numbers[2], step, -radius)
    v = dr.fma(Float(_every_other_bit(cell >> 1)) + numbers[3], step, -radius)
    return across(direction, u, v), direction


def across(direction, u, v):
    """Return the point (u, v) of the plane through the centre, in an orthonormal frame about a unit direction
    (T. Duff and others, "Building an orthonormal basis, revisited", JCGT 6(1), 2017)."""
    x, y, z = direction
    sign = dr.select(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    b = x * y * a
    first = type(direction)(1 + sign * x * x * a, sign * b, -sign * x)
    second = type(direction)(b, sign + y * y * a, -y)
    return first * u + second * v


def _every_other_bit(code):
    """Return bits 0, 2, 4, ... of a UInt32, side by side."""
    code = code & 0x55555555
    for shift, mask in ((1, 0x33333333), (2, 0x0F0F0F0F), (4, 0x00FF00FF), (8, 0x0000FFFF)):
        code = (code | (code >> shift)) & mask
    return code
