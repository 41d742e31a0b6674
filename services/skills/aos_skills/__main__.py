"""`python -m aos_skills SETTINGS.json`: the skills service as a process."""

from aos_runtime.lifecycle import run_service
from aos_skills.service import serve
from aos_skills.settings import Settings

if __name__ == "__main__":
    run_service(Settings, serve)
