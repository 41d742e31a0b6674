"""`python -m aos_runtime.router SETTINGS.json`: the bus router as a process."""

from aos_runtime.processes.lifecycle import run_process
from aos_runtime.router.routing import RouterSettings, route

if __name__ == "__main__":
    run_process(RouterSettings, route)
