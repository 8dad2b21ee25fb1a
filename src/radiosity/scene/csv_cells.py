"""Names in cells of CSV files: spreadsheets take no name for a formula, and readers get each name back as it was.

A spreadsheet takes a cell for a formula that begins with ``=``, ``+``, ``-``, ``@``, a tab or a carriage return, also where
the cell is quoted. Names come from files of strangers. OWASP (CSV Injection; CWE-1236) advises an apostrophe before such a name.
"""

import re

FORMULA = re.compile(r"'*[=+\-@\t\r]")


def guarded(value):
    """Return a name with an apostrophe before it where a spreadsheet would take it for a formula; anything else as it is.

    Numbers in text are no formulas. A name that already begins with apostrophes and such a character gets one more, so that
    `unguarded` gives every name back.

    >>> guarded("=1+1"), guarded("wall"), guarded("-2.5"), guarded(-2.5)
    ("'=1+1", 'wall', '-2.5', -2.5)
    """
    return f"'{value}" if isinstance(value, str) and FORMULA.match(value) and not is_number(value) else value


def unguarded(text: str) -> str:
    """Return the name that `guarded` wrote.

    >>> unguarded("'=1+1"), unguarded("'quoted'")
    ('=1+1', "'quoted'")
    """
    return text[1:] if text.startswith("'") and FORMULA.match(text) else text


def is_number(text: str) -> bool:
    """Return whether a cell is a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True
