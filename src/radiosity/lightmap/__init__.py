"""Lightmaps: light on a texture, with a place for each point of each radiating side, for programs that show textured meshes."""
