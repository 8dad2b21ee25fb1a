"""Writers of scene files: a scene goes to a file that reads back as the same scene, and what the format cannot hold is told."""
