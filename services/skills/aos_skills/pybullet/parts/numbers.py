"""The numbers of world files."""

from typing import Annotated

import msgspec

Share = Annotated[float, msgspec.Meta(ge=0, le=1)]
"""A probability."""
Deviation = Annotated[float, msgspec.Meta(ge=0)]
"""A standard deviation."""
Length = Annotated[float, msgspec.Meta(gt=0)]
"""A length, or a factor of one."""
