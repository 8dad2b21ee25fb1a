"""Lines through the whole scene, their spans, and the two ways to carry power along them: multipath and pooling."""
