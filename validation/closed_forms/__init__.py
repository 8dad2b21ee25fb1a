"""Form factors and enclosures that have exact answers; `tests/test_closed_form_integrals.py` checks them by numerical integration."""
