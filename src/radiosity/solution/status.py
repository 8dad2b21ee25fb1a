"""The statuses of a solution that more than one file asks for."""

NOT_REACHED = "not reached"  # the error is above the error target, or unknown
