"""Annual daylight: what sensors get in each hour of a year, from coefficients of sky patches and the sun of each hour."""
