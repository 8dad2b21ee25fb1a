"""Form factors from counted lines, and the equation solved with them."""
