"""The interface that adapters are written against, ours and anybody else's.

An adapter turns calls into motion and the robot's data into topics. It is a class; `python -m
aos_runtime.adapters` runs one of it in a process of its own.
"""

from aos_runtime.adapters.adapter import Adapter, Answer, Call, Observed
from aos_runtime.adapters.host import Host
from aos_runtime.adapters.settings import AdapterSettings, Binding

__all__ = ["Adapter", "AdapterSettings", "Answer", "Binding", "Call", "Host", "Observed"]
