"""Heat between surfaces, from counted lines: what depends on temperatures, emissivities and heat flows."""
