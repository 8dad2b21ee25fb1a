"""What others say about our solutions: closed forms, exact view factors, Mitsuba's path tracer and Radiance.

``make validate`` (or ``python -m validation``, from the top folder) runs all of them and writes docs/validation. Each referee is
a file whose ``run`` yields comparisons; `comparison.py` has their statistics, `page.py` the page.
"""
