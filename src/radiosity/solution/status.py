"""How a run ended: the statuses of a solution that more than one file asks for."""

NOT_REACHED = "not reached"  # above the error that the run was to reach, or it could not be told
