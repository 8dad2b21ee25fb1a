"""The panel beside the page: what can be chosen, and what is told."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..errors import RadiosityError
from . import eye, frame, html, numbers
from .look import FLAT, SMOOTH, Look
from .page import Page
from .picking import Cut, pick
from .shades import Colours

LIGHT, FALSE = "as light", "false colours"
LINEAR, LOG = "linear", "logarithmic"
MAPS = ("viridis", "inferno", "turbo", "cividis", "gray")
ALL, NOWHERE = "all bands", "no cut"
AXES = ("x", "y", "z")
STEPS = 200  # of the cut's slider


@dataclass(eq=False)
class Panel:
    """The panel of a page.

    Attributes:
        page: that it changes.
        told: text about the scene, as Markdown.
        views: cameras by name.
        parts: what can be chosen, by name.
        colours: those that were drawn last.
    """

    page: Page
    told: str
    views: dict[str, Any]
    parts: dict[str, Any] = field(default_factory=dict)
    colours: Colours | None = None

    def build(self) -> None:
        """Put all parts on the page, and listen to them."""
        gui, page = self.page.server.gui, self.page
        self.parts["message"] = gui.add_markdown("", visible=False)
        with gui.add_folder("Light"):
            self._light(gui)
        self.parts["legend"] = gui.add_image(np.zeros((2, 2, 3), np.uint8), format="png", visible=False)
        with gui.add_folder("Patch"):
            self.parts["patch"] = gui.add_markdown("click a patch for its numbers")
        with gui.add_folder("Surfaces"):
            self._surfaces(gui)
        with gui.add_folder("Cut", expand_by_default=False):
            self._cut(gui)
        with gui.add_folder("View", expand_by_default=False):
            self._view(gui)
        with gui.add_folder("About", expand_by_default=self.page.content.subject.solution is None):
            self.parts["about"] = gui.add_markdown(self.told)
        page.failed = self._failed

    def _light(self, gui) -> None:
        look, subject = self.page.look, self.page.content.subject
        names, bands = subject.names, tuple(str(band) for band in subject.patches.scene.bands)
        first = next(iter(names)) if look.quantity is None else look.quantity
        shades = look.shades
        low, high = ("", "") if shades.limits is None else (format(value, ".6g") for value in shades.limits)
        self._add("quantity", gui.add_dropdown("Quantity", tuple(names.values()), initial_value=names[first]))
        if len(bands) > 1:
            self._add("band", gui.add_dropdown("Band", (ALL, *bands), initial_value=look.band or ALL))
        self._add("detail", gui.add_dropdown("Detail", (SMOOTH, FLAT), initial_value=SMOOTH if look.smooth else FLAT))
        self._add("colours", gui.add_dropdown("Colours", (LIGHT, FALSE), initial_value=FALSE if shades.false else LIGHT))
        self._add(
            "exposure", gui.add_slider("Exposure", -8.0, 8.0, 0.25, float(np.clip(shades.exposure, -8, 8)), hint="in stops")
        )
        self._add("scale", gui.add_dropdown("Scale", (LINEAR, LOG), initial_value=LOG if shades.log else LINEAR))
        maps = MAPS if shades.color_map in MAPS else (*MAPS, shades.color_map)
        self._add("map", gui.add_dropdown("Colour map", maps, initial_value=shades.color_map))
        self._add("low", gui.add_text("Lowest", low, hint="of the legend; empty: automatic"))
        self._add("high", gui.add_text("Highest", high, hint="of the legend; empty: automatic"))
        self._add("wireframe", gui.add_checkbox("Edges of patches", look.wireframe))
        self._add("marks", gui.add_checkbox("Sensors and luminaires", look.marks))
        self._dim()

    def _surfaces(self, gui) -> None:
        names = tuple(dict.fromkeys(self.page.content.subject.patches.scene.names))
        self.parts["surface"] = gui.add_dropdown("Surface", names)
        buttons = gui.add_button_group("Show", ("hide", "only this", "all"))

        @buttons.on_click
        def _(event) -> None:
            number = names.index(self.parts["surface"].value)
            every = frozenset(range(len(names)))
            hidden = {"hide": self.page.look.hidden | {number}, "only this": every - {number}, "all": frozenset()}
            self.page.change(hidden=hidden[event.target.value])

    def _cut(self, gui) -> None:
        self._add("axis", gui.add_dropdown("Across", (NOWHERE, *AXES), initial_value=NOWHERE))
        self._add("place", gui.add_slider("Place", 0.0, 100.0, 100.0 / STEPS, 50.0, hint="in % of the scene's size"))
        self._add("below", gui.add_checkbox("Cut away below", False))
        self.parts["at"] = gui.add_markdown("")

    def _view(self, gui) -> None:
        subject, place = self.page.content.subject, self.page.content.frame
        views = gui.add_dropdown("Go to", tuple(self.views))
        go, save = gui.add_button("Go there"), gui.add_button("Save picture (PNG)")
        whole, options = gui.add_button("Save page (HTML)"), gui.add_markdown("")

        @go.on_click
        def _(event) -> None:
            eye.move(event.client, self.views[views.value], subject, place)

        @save.on_click
        def _(event) -> None:
            self._try(lambda: self._download(event.client, options))

        @whole.on_click
        def _(event) -> None:
            if self.colours is not None:
                text = html.document(self.page.server, self.colours)
                event.client.send_file_download("view.html", text.encode(), save_immediately=True)

    def _download(self, client, options) -> None:
        if self.colours is None:  # nothing was drawn yet
            return
        place = self.page.content.frame
        client.send_file_download("view.png", eye.picture(client, place, self.colours), save_immediately=True)
        options.content = (
            f"the same view:\n\n`radiosity render SOLUTION.npz -o view.png {frame.options(eye.seen_by(client, place))}`"
        )

    def _try(self, action) -> None:
        try:
            action()
        except (RadiosityError, RuntimeError, TimeoutError) as error:  # of the library: the page gave no picture
            self._failed(str(error))

    def _add(self, name: str, part) -> None:
        self.parts[name] = part
        part.on_update(lambda event: self._changed(name))

    def _changed(self, name: str) -> None:
        if name == "quantity":
            self.parts["low"].value = self.parts["high"].value = ""  # another quantity has another range
        self._dim()
        try:
            self.page.show(self._look())
        except ValueError as error:
            self._failed(str(error))

    def _look(self) -> Look:
        """Return the look that the panel asks for.

        Raises:
            ValueError: a number is none.
        """
        value = {name: part.value for name, part in self.parts.items() if hasattr(part, "value")}
        titles = self.page.content.subject.names
        band = value.get("band", ALL)
        shades = replace(
            self.page.look.shades,
            false=value["colours"] == FALSE,
            log=value["scale"] == LOG,
            limits=_limits(value["low"], value["high"]),
            color_map=value["map"],
            exposure=value["exposure"],
        )
        return replace(
            self.page.look,
            quantity=next(name for name, title in titles.items() if title == value["quantity"]),
            band=None if band == ALL else band,
            smooth=value["detail"] == SMOOTH,
            shades=shades,
            wireframe=value["wireframe"],
            marks=value["marks"],
            cut=self._plane(value) if "axis" in value else None,
        )

    def _plane(self, value: dict) -> Cut | None:
        if value["axis"] == NOWHERE:
            self.parts["at"].content = ""
            return None
        axis = AXES.index(value["axis"])
        low, high = self.page.content.subject.patches.scene.bounds[:, axis]
        at = float(low + (high - low) * value["place"] / 100)
        self.parts["at"].content = f"{value['axis']} = {at:.4g} m"
        return Cut(axis, at, value["below"])

    def _dim(self) -> None:
        """Show only what has a meaning for the colours that are chosen."""
        if "high" not in self.parts:
            return
        false = self.parts["colours"].value == FALSE
        self.parts["exposure"].visible = not false
        for name in ("scale", "map", "low", "high"):
            self.parts[name].visible = false

    def drawn(self, colours: Colours) -> None:
        """Show the legend of the colours that were drawn."""
        self.colours = colours
        legend, message = self.parts["legend"], self.parts["message"]
        picture = colours.legend()
        if picture is not None:
            legend.image = picture
        legend.visible = picture is not None
        message.content, message.visible = colours.label if picture is None else "", picture is None

    def _failed(self, text: str) -> None:
        self.parts["message"].content, self.parts["message"].visible = f"**{numbers.plain(text)}**", True

    def clicked(self, event) -> None:
        """Tell the numbers of the patch at a click."""
        content, look = self.page.content, self.page.look
        patches = content.subject.patches
        hidden = np.isin(np.arange(len(patches.scene.names)), list(look.hidden))
        found = pick(patches, content.frame.to_scene(event.ray_origin), event.ray_direction, hidden, look.cut)
        if found is None:
            self.parts["patch"].content = "nothing there"
            return
        self.parts["patch"].content = numbers.told(content.subject, *found)
        self.parts["surface"].value = patches.scene.names[patches.surface[found[0]]]


def _limits(low: str, high: str) -> tuple[float, float] | None:
    """Return the ends of a legend from two fields; None where both are empty.

    Raises:
        ValueError: one is empty or no number.
    """
    if not low.strip() and not high.strip():
        return None
    try:
        return float(low), float(high)
    except ValueError:
        raise ValueError(f"the range is '{low}' to '{high}'; write two numbers, or leave both empty") from None
