"""A page as one HTML file, which needs no server and no network."""

import base64
import html
import io

from .library import Server
from .shades import Colours

# not quite opaque: behind what is opaque, Chromium without a graphics card leaves out a part of the page that lies elsewhere
STYLE = (
    "position:fixed;left:12px;bottom:12px;width:auto;height:auto;z-index:10;opacity:0.999;"
    "background:white;color:black;font:12px sans-serif;padding:6px"
)


def document(server: Server, colours: Colours) -> str:
    """Return the page that a server has, as it is now, with its legend."""
    page = server.scene.as_html(dark_mode=True)
    legend = colours.legend()
    inside = f"<div>{html.escape(colours.label)}</div>"
    if legend is not None:
        from PIL import Image

        buffer = io.BytesIO()
        Image.fromarray(legend).save(buffer, format="PNG")
        inside = (
            f'<img alt="{html.escape(colours.label)}" src="data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}">'
        )
    end = page.rindex("</body>")
    return f'{page[:end]}<div id="radiosity-legend" style="{STYLE}">{inside}</div>{page[end:]}'
