"""The messages on the bus, one module for each conversation.

Every payload is an `Envelope` whose body is one of these structures. Times are wall-clock nanoseconds for
people and journals; nothing is decided by them. Unknown fields are ignored, so that minor versions mix.
"""

from aos_protocol.messages.base import *
from aos_protocol.messages.bundles import *
from aos_protocol.messages.mission import *
from aos_protocol.messages.records import *
from aos_protocol.messages.skills import *
from aos_protocol.messages.steering import *
from aos_protocol.messages.study import *
