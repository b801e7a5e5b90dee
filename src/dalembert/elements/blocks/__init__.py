"""Blocks: controllers, filters and other first-order states."""

from dalembert.elements.blocks.lead_lag import LeadLag
from dalembert.elements.blocks.low_pass import LowPass
from dalembert.elements.blocks.pid import PID
from dalembert.elements.blocks.state import State
from dalembert.elements.blocks.state_space import StateSpace
from dalembert.elements.blocks.transfer_function import TransferFunction

__all__ = ["PID", "LeadLag", "LowPass", "State", "StateSpace", "TransferFunction"]
