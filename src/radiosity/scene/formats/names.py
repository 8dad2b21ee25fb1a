"""Names of objects that a file gives several times."""


def numbered(name: str, taken: dict[str, int]) -> str:
    """The name, with a number where another object has it: name#2, name#3, ...

    Args:
        taken: how often each name was taken so far; it is brought up to date.
    """
    taken[name] = taken.get(name, 0) + 1
    if taken[name] == 1:
        return name
    return numbered(f"{name}#{taken[name]}", taken)


def repeated(names: list[str]) -> list[str]:
    """The names that come several times, with their number, for a message."""
    return [f"{name} ({names.count(name)})" for name in dict.fromkeys(names) if names.count(name) > 1]
