"""`python -m aos_solver SETTINGS.json`: the solver service as a process."""

from aos_runtime.processes.lifecycle import run_service
from aos_solver.service import serve
from aos_solver.settings import Settings

if __name__ == "__main__":
    run_service(Settings, serve)
