"""The choice between searching and following a policy file, for commands that may have either."""

from pathlib import Path

import msgspec

from aos_solver.child.engine import Engine
from aos_solver.child.search import Search


def following(search: Search, policy: Path | None, *, engine: Engine | None = None) -> Search:
    """The search itself, or one that follows the policy file where there is one.

    PlanningError where the file cannot be read, and where the policy is not for the model of this engine.
    """
    if policy is None:
        return search
    # Numbers take a tenth of a second to import, and few missions need them.
    from aos_solver.offline.policy import Policy, PolicySearch

    loaded = Policy.load(policy)
    if engine is not None:
        loaded.check_model(engine.model_digest, engine.description.mission_parameters)
    return PolicySearch(policy=loaded, **msgspec.structs.asdict(search))
