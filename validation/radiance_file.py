"""A scene as Radiance has it. Radiance works in radiance, so an exitance E becomes E / pi; colours are bands, with no factor of
179 lm/W, since nothing is photometric. Materials are Lambertian: plastic without specularity and roughness."""

import numpy as np

import radiosity as rd

LEAST = 1e-4  # of a mixture: the glow's part
APART = 1e-6  # of the scene's extent, between the sheets that stand for two different sides of a face


def text(scene: rd.Scene) -> str:
    """Materials and polygons.

    Lamps that reflect nothing are Radiance's ``light``, sampled as sources. What emits and reflects is a mixture of plastic and
    ``glow``, which paths find. Both shine from their front alone. A face that is not the same on both sides is a mixture with
    black by the side that a ray comes from, and a second such face turned round where the back is not black.
    """
    materials = _Materials()
    apart = APART * float(np.ptp(scene.bounds, axis=0).max())
    polygons = []
    for face in range(scene.n_faces):
        corners = scene.vertices[scene.faces[face][: 4 if scene.is_quad[face] else 3]]
        if scene.back[face] == rd.Back.PASSES:
            raise ValueError(f"face {face} lets light pass from behind, which Radiance has no opaque material for")
        if scene.panes[face] or scene.diffusers[face]:
            polygons.append((materials.trans(scene, face), corners))
            continue
        front = scene.reflectance[face], scene.emission[face]
        back = scene.back_reflectance[face], scene.back_emission[face]
        radiates = scene.back[face] == rd.Back.RADIATES
        if radiates and np.array_equal(front, back) and not front[1].any():
            polygons.append((materials.of(*front), corners))
            continue
        polygons.append((materials.one_sided(*front), corners))
        if radiates and (back[0].any() or back[1].any()):
            polygons.append((materials.one_sided(*back), corners[::-1] - apart * scene.normal[face]))
    lines = [f"{name} polygon f{i} 0 0 {p.size} {_numbers(p.ravel())}" for i, (name, p) in enumerate(polygons)]
    return "\n".join([*materials.lines, *lines]) + "\n"


class _Materials:
    """Lines that define them, and names by what they are."""

    def __init__(self):
        self.lines, self.known = ["void plastic black 0 0 5 0 0 0 0 0"], {}

    def of(self, reflectance, emission) -> str:
        """The same on both sides, but that only the front emits."""
        colour, radiance = np.broadcast_to(reflectance, 3), np.broadcast_to(emission, 3) / np.pi
        if not colour.any() and not radiance.any():
            return "black"
        key = (*colour, *radiance)
        if key in self.known:
            return self.known[key]
        self.known[key] = name = f"m{len(self.known)}"
        if not colour.any():
            self.lines.append(f"void light {name} 0 0 3 {_numbers(radiance)}")
        elif not radiance.any():
            self.lines.append(f"void plastic {name} 0 0 5 {_numbers(colour)} 0 0")
        else:
            share = max(0.5, colour.max() / (1 - LEAST))  # so that no plastic reflects more than it receives
            self.lines.append(f"void plastic {name}p 0 0 5 {_numbers(colour / share)} 0 0")
            self.lines.append(f"void glow {name}g 0 0 4 {_numbers(radiance / (1 - share))} 0")
            self.lines.append(f"void mixfunc {name} 4 {name}p {name}g {share:.17g} . 0 0")
        return name

    def trans(self, scene: rd.Scene, face: int) -> str:
        """A pane: its colour is what it does not absorb, of which a share goes through, and a part of that straight on."""
        reflected, clear = scene.reflectance[face], 0.0 if scene.transmittance is None else scene.transmittance[face]
        diffused = 0.0 * reflected if scene.diffuse_transmittance is None else scene.diffuse_transmittance[face]
        colour = reflected + diffused + clear
        through, straight = (diffused + clear) / colour, clear / (diffused + clear)
        if np.ptp(through) > 1e-9 or np.ptp(straight) > 1e-9 or scene.emission[face].any():
            raise ValueError(f"face {face} divides its light among its sides in another way in each band, or emits")
        key = ("trans", *np.broadcast_to(colour, 3), through[0], straight[0])
        if key not in self.known:
            self.known[key] = name = f"t{len(self.known)}"
            self.lines.append(f"void trans {name} 0 0 7 {_numbers(key[1:4])} 0 0 {_numbers(key[4:])}")
        return self.known[key]

    def one_sided(self, reflectance, emission) -> str:
        """Black from behind; a light is so by itself."""
        front = self.of(reflectance, emission)
        if front == "black" or not np.any(reflectance):
            return front
        if front not in self.known:
            self.known[front] = f"{front}s"
            self.lines.append(f'void mixfunc {front}s 4 {front} black "if(Rdot,1,0)" . 0 0')
        return self.known[front]


def _numbers(values) -> str:
    return " ".join(f"{value:.17g}" for value in values)
