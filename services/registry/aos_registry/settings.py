"""The settings that the registry service is started with."""

from aos_runtime.processes.settings import ServiceSettings


class Settings(ServiceSettings, frozen=True, kw_only=True):
    """`watch` is the folder whose sub-folders are taken as bundles; empty means `<run_dir>/drop`.

    The catalogue is `<run_dir>/catalogue.db` unless `catalogue` names another file. A dropped folder counts
    as complete when nothing in it changed for `quiet_s`.
    """

    watch: str = ""
    catalogue: str = ""
    quiet_s: float = 0.4
    model_check_timeout_s: float = 180.0
