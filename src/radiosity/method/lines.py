"""The axis of lines: the kind of line that carries a particle."""

LINES = {
    "local": "lines from patches, cosine distributed about their normals",
    "global": "lines through the whole scene, by two points of its bounding sphere; all their spans",
    "global-disc": "the same lines, by a direction and a point of the disc across it",
    "spans": "spans of global lines drawn one by one: from a point uniform on all surfaces, cosine distributed",
    "bundles": "bundles of parallel lines, a direction at a time",
}
