"""Vectors of kernels: lists of three numbers."""


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def square(a):
    return dot(a, a)


def minus(a, b) -> list:
    return [x - y for x, y in zip(a, b, strict=True)]


def plus(a, b) -> list:
    return [x + y for x, y in zip(a, b, strict=True)]
