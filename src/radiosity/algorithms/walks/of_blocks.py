"""What traces the legs of walks in a block of sequence indices (`sampling.blocks`)."""

from ...tracing.line_tracer import LineTracer
from .particles import PathSegments


class OfBlocks:
    """Tracers and segments of the first block, and of the last other one that was asked for."""

    def __init__(self, tracer: LineTracer, segments: PathSegments):
        self._known = {0: (tracer, segments)}

    def at(self, block: int) -> tuple[LineTracer, PathSegments]:
        """Return those of a block."""
        if block not in self._known:
            tracer, segments = self._known[0]
            self._known = {0: (tracer, segments), block: (tracer.of_block(block), segments.in_block(block))}
        return self._known[block]
