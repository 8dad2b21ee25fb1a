"""A viewer in the browser: what a solution holds, or a scene before it is solved."""
