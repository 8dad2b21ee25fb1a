"""Form factors and enclosures that have exact answers; `tests/test_exact_integrals.py` checks them by numerical integration."""
