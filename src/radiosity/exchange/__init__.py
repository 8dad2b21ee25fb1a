"""Exchange between surfaces: view factors and what follows from them, as values with errors."""
