"""Progressive refinement radiosity: shot after shot, rows of form factors on demand."""
