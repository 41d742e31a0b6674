"""`python -m aos_middleware SETTINGS.json`: the middleware service as a process."""

from aos_middleware.service import serve
from aos_middleware.settings import Settings
from aos_runtime.processes.lifecycle import run_service

if __name__ == "__main__":
    run_service(Settings, serve)
