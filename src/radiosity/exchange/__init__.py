"""Exchange between surfaces by radiation: view factors, net heat and temperatures, from counted lines, as values with errors."""
