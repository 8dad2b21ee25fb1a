"""Line sets: lines counted between patches, which depend on the geometry alone and solve any emission and reflectance."""
