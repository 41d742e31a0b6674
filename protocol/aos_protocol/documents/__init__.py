"""The documents as typed data: one model for every dialect.

Written by the registry's readers, sent over the bus, read by the solver's lowering and the middleware's
emission. Nothing here is interpreted: code stays text, in `Snippet`, with the place every line came from.
Names follow the field (skill, response, local variable); the documents' own spellings stay in the readers.

Source: the paper, sections 3.2.1 and 3.2.2; the AOS documentation manual, versions 1.2 and 2.0.
"""

from aos_protocol.documents.code import *
from aos_protocol.documents.environment import *
from aos_protocol.documents.mapping import *
from aos_protocol.documents.project import *
