"""What lines of a gather find: light of lamps, of the sky, and of lights without area.

Cosine lines leave a patch and read the radiosity where they hit. Shadow rays go to points of lamps. Both can find the light of a
lamp's point; each pair of points counts for one of them (the maximum heuristic: E. Veach and L. Guibas, "Optimally combining
sampling techniques for Monte Carlo rendering", SIGGRAPH 1995). A cosine line counts where its density over the lamp, the kernel
cos cos' / (pi r^2), is above `KERNEL` times that of the shadow ray. So what a shadow ray brings is bounded. The sky through an
opening is shared in the same way: a direction belongs to the first opening on it. Luminaires and suns are found by shadow rays
alone.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...sampling.hemisphere import triangle
from ...tracing.against import light_along, sends
from ...tracing.faces import COLUMN_BITS, QUAD
from ...tracing.hits import first_hit, patch_of
from ...tracing.ray_generation import MASK, Frame
from .chances import Chances
from .glow import Glow
from .lamps import NONE
from .packets import Packets

KERNEL = 1 / 3  # of the density of shadow rays: above this kernel, cosine lines count
TOUCHES = 1 - 1e-5  # of a light's distance: what a ray hits so near to it is no obstacle, such as the ceiling that it hangs on


@dataclass(frozen=True, eq=False)
class Targets:
    """What lines find; all values are in shares of `Problem.unit`, for each group of bands.

    Attributes:
        packets: the lanes.
        chances: of what shadow rays go to.
        emission: of each group of bands, (n_patches + 2,) Float.
        sky: what lines see that leave the scene, where there is a sky.
    """

    packets: Packets
    chances: Chances
    emission: list
    sky: Glow | None

    @property
    def types(self):
        return self.packets.types

    @property
    def small(self) -> bool:
        """True where values are bounded, so that 32 bits hold them in fixed point."""
        panes = self.packets.geometry.panes
        return self.sky is None and self.chances.beams is None and (panes is None or panes.angles is None)

    # ---- cosine lines ----------------------------------------------------------------------------------------------

    def met(self, met, hit, origin, direction, normal, row) -> list:
        """Return the emission that cosine lines find, where it counts for them; called in a kernel.

        Args:
            met: the patch that each hits, or a code.
            normal: of the receiver, towards where lines leave.
            row: where the receiver's chances begin.
        """
        types, lamps = self.types, self.chances.lamps
        if lamps.n_faces:
            lamp = dr.gather(types.UInt32, lamps.lamp_of_patch, met)
            lit = lamp != NONE
            facing = dr.gather(types.Array3f, lamps.normals, lamp, lit)
            kernel = dr.dot(normal, direction) * -dr.dot(facing, direction) * (1 / np.pi)
            density = self.chances.density_of(row, lamp, lit)
            counted = lit & (kernel > KERNEL * density * hit.distance * hit.distance)
            values = [dr.gather(types.Float, column, met, counted) for column in self.emission]
        else:
            values = [dr.zeros(types.Float, self.packets.lanes) for _ in self.emission]
        return values if self.sky is None else self._with_sky(values, met == self.packets.n, origin, direction, normal, row)

    def _with_sky(self, values: list, escaped, origin, direction, normal, row) -> list:
        """Return what cosine lines meet, with the sky where they escape, unless it counts for shadow rays through an opening;
        called in a kernel."""
        assert self.sky is not None
        counted, openings, lamps = escaped, self.chances.lamps.openings, self.chances.lamps
        if openings is not None:
            found, distance, front = openings.nearest(origin, direction, escaped)
            crosses = escaped & (found != NONE)
            lamp = dr.select(crosses, found + dr.select(front, self.types.UInt32(0), openings.count) + lamps.n_faces, 0)
            facing = dr.gather(self.types.Array3f, lamps.normals, lamp, crosses)
            kernel = dr.dot(normal, direction) * -dr.dot(facing, direction) * (1 / np.pi)
            density = self.chances.density_of(row, lamp, crosses)
            counted = escaped & (~crosses | (kernel > KERNEL * density * distance * distance))
        return [dr.select(counted, one, old) for one, old in zip(self.sky.shares(direction), values, strict=True)]

    # ---- shadow rays -----------------------------------------------------------------------------------------------

    def brought(self, origin, normal, row, u) -> tuple[list, Any]:
        """Trace a shadow ray from each receiver, and return what it brings, and its direction; called in a kernel.

        Args:
            u: numbers; the fifth chooses the target, the first two a point of it.
        """
        types, chances = self.types, self.chances
        Float, beams, openings = types.Float, chances.beams, chances.lamps.openings
        lamp, density = chances.choose(row, u[4])
        end, facing, first, cells = self._point_of(lamp, u)
        way = end - origin
        square = dr.squared_norm(way)
        direction = way * dr.rsqrt(square)
        kernel = dr.dot(direction, normal) * -dr.dot(direction, facing) * (1 / np.pi)
        bound = density * square
        faces = (dr.dot(direction, normal) > 0) & (dr.dot(direction, facing) < 0) & (kernel <= KERNEL * bound)
        arrival = None
        if beams is not None:
            aimed = lamp >= chances.n_lamps
            light = dr.select(aimed, lamp - chances.n_lamps, 0)
            towards, distance, share = beams.lights.arrive(light, origin, (u[0], u[1]))
            direction = dr.select(aimed, towards, direction)
            above = dr.dot(towards, normal)
            faces = dr.select(aimed, (above > 0) & (share > 0), faces)
            arrival = aimed, light, distance, above * share / density, beams.powers
        own = () if beams is None else (u[0], u[1])  # rays of a sensor to a point lamp are all the same
        met, escapes, end = self._end(origin, direction, faces, own, first, cells)
        seen = faces & (met - first < cells)
        part = dr.select(seen, kernel / bound, 0)
        values = [part * dr.gather(Float, column, met, seen) for column in self.emission]
        if openings is not None and self.sky is not None:
            through = faces & (lamp >= chances.lamps.n_faces) & (lamp < chances.n_lamps) & escapes
            number, _, front = openings.nearest(origin, direction, through)
            side = number + dr.select(front, types.UInt32(0), openings.count)
            through &= side == lamp - chances.lamps.n_faces
            sky = self.sky.shares(direction)
            values = [dr.select(through, kernel / bound * one, old) for one, old in zip(sky, values, strict=True)]
        if arrival is not None:
            aimed, light, distance, part, powers = arrival
            arrives = faces & aimed & (escapes | (end >= distance * TOUCHES))
            of_lights = [part * dr.gather(Float, column, light, aimed) for column in powers]
            values = [dr.select(arrives, one, old) for one, old in zip(of_lights, values, strict=True)]
        return values, direction

    def _end(self, origin, direction, active, own, first, cells):
        """Return the patch that shadow rays end on, whether they leave the scene, and how far they go; called in a kernel.

        Against the light (`tracing.against`) they go on through fronts, and the patch is the first of ``cells`` that they meet.
        """
        packets, geometry, types = self.packets, self.packets.geometry, self.types
        if not geometry.some_backs_pass:
            hit = first_hit(geometry, origin, direction, coherent=packets.coherent, active=active, own=own)
            return patch_of(geometry, hit, packets.n + 1, packets.n), ~hit.valid, hit.distance
        width, nobody = packets.lanes, packets.n + 1

        def visit(hit, stops, met, found, escapes, end):
            patch = dr.select(met & sends(hit), patch_of(geometry, hit, nobody, nobody), nobody)
            ends = stops & hit.valid
            return (
                dr.select(patch - first < cells, patch, found),
                escapes | (stops & ~hit.valid),
                dr.select(ends, hit.distance, end),
            )

        state = (dr.full(types.UInt32, nobody, width), dr.full(types.Bool, False, width), dr.full(types.Float, np.inf, width))
        return light_along(geometry, origin, direction, visit, state, coherent=packets.coherent, active=active, own=own)

    def _point_of(self, lamp, u):
        """Return a point of a lamp, the lamp's normal, its first patch and their number; called in a kernel."""
        types, lamps = self.types, self.chances.lamps
        if not lamps.n_faces:
            nothing = types.UInt32(0)
            end, facing = self._point_of_opening(lamp, u) if lamps.openings is not None else (types.Array3f(0), types.Array3f(0))
            return end, facing, nothing, nothing
        if self.chances.targets == lamps.n_faces:
            return self._point_of_face(lamp, u)
        end, facing, first, cells = self._point_of_face(dr.minimum(lamp, lamps.n_faces - 1), u)
        is_face = lamp < lamps.n_faces
        if lamps.openings is not None:
            there, towards = self._point_of_opening(dr.maximum(lamp, lamps.n_faces), u)
            end, facing = dr.select(is_face, end, there), dr.select(is_face, facing, towards)
        return end, facing, first, dr.select(is_face, cells, 0)

    def _point_of_opening(self, lamp, u):
        """Return a point of an opening and the normal of its side; called in a kernel."""
        lamps = self.chances.lamps
        assert lamps.openings is not None
        side = lamp - lamps.n_faces
        back = side >= lamps.openings.count
        number = dr.minimum(dr.select(back, side - lamps.openings.count, side), lamps.openings.count - 1)
        end, normal = lamps.openings.point(number, u[0], u[1], True)
        return end, dr.select(back, -normal, normal)

    def _point_of_face(self, lamp, u):
        """Return a point of a lamp that is a face, its normal, its first patch and their number; called in a kernel."""
        types = self.types
        face, counts, first, cells = dr.gather(types.Array4u, self.chances.lamps.records, lamp)
        frame = Frame.of(self.packets.geometry, face)
        a, b = triangle(u[0], u[1])
        quad = (counts & QUAD) != 0
        s, t = dr.select(quad, u[0], a), dr.select(quad, u[1], b)
        s, t = s * types.Float(counts & MASK), t * types.Float((counts >> COLUMN_BITS) & MASK)
        return frame.origin + frame.first * s + frame.second * t, frame.normal * frame.side, first, cells
