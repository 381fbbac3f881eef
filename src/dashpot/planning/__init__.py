"""What a test can and cannot tell, before it is run."""

from dashpot.planning.plan import plan
from dashpot.planning.records import ExpectedError, Plan, Pulse, RecordNeed

__all__ = ["ExpectedError", "Plan", "Pulse", "RecordNeed", "plan"]
