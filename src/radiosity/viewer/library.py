"""Names for objects of viser, which is loaded only where a page is served."""

from typing import Any, TypeAlias

Server: TypeAlias = Any  # a `viser.ViserServer`
Client: TypeAlias = Any  # a `viser.ClientHandle`, one for each page that is open
