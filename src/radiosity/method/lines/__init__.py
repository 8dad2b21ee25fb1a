"""What carries a particle?"""

LINES = ("local",)
