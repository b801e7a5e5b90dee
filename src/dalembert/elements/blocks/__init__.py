"""Blocks: controllers, filters and other first-order states, continuous and sampled."""

from dalembert.elements.blocks.lead_lag import LeadLag
from dalembert.elements.blocks.low_pass import LowPass
from dalembert.elements.blocks.pid import PID, SampledPID
from dalembert.elements.blocks.sampled_signals import (
    Delay,
    Quantizer,
    SampledState,
    ZeroOrderHold,
)
from dalembert.elements.blocks.state import State
from dalembert.elements.blocks.state_space import SampledStateSpace, StateSpace
from dalembert.elements.blocks.transfer_function import SampledTransferFunction, TransferFunction
from dalembert.elements.blocks.transport_delay import TransportDelay

__all__ = [
    "PID",
    "Delay",
    "LeadLag",
    "LowPass",
    "Quantizer",
    "SampledPID",
    "SampledState",
    "SampledStateSpace",
    "SampledTransferFunction",
    "State",
    "StateSpace",
    "TransferFunction",
    "TransportDelay",
    "ZeroOrderHold",
]
