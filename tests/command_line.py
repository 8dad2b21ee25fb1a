"""Commands within the test process."""

from radiosity.cli import main


def run(capsys, *arguments) -> tuple[int, str, str]:
    """Run a command; its exit status, and what it wrote to standard output and standard error."""
    status = main([str(argument) for argument in arguments])
    out, err = capsys.readouterr()
    return status, out, err
