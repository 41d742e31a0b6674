"""The registry service as a process: `python -m aos_registry SETTINGS.json`."""

from aos_registry.service import serve
from aos_registry.settings import Settings
from aos_runtime.processes.lifecycle import run_service

if __name__ == "__main__":
    run_service(Settings, serve)
