"""The settings that the middleware service is started with."""

from aos_runtime.processes.settings import ServiceSettings


class Settings(ServiceSettings, frozen=True, kw_only=True):
    """`project` names the documents to ask the registry for.

    `activation_timeout_s` holds for an activation that comes without a deadline. Generated modules go to
    `generated_dir`, by default `<run_dir>/generated/python`. Mapping code may import any module unless
    `allowed_imports` names the top-level ones; it has `load_s` to load and `evaluation_s` for each function.
    The skills at the paths of `played` are played by their documents, `"*"` stands for all but `elsewhere`.
    """

    project: str
    activation_timeout_s: float = 120.0
    generated_dir: str = ""
    load_s: float = 5.0
    evaluation_s: float = 0.5
    allowed_imports: tuple[str, ...] | None = None
    played: tuple[str, ...] = ()
    elsewhere: tuple[str, ...] = ()

    def is_played(self, path: str) -> bool:
        """Returns whether the skill at a path is played by its document, which needs no fields."""
        path = "/" + path.strip("/")
        return path in self.played or ("*" in self.played and path not in self.elsewhere)
