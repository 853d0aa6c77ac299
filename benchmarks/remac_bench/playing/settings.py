"""How jobs are run, one row an option; nothing here changes a result, but for a job whose time is up."""

from __future__ import annotations

from dataclasses import dataclass

from remac_bench.errors import UsageError
from remac_env.option_rows import Choice, Real, Switch, Texts, Whole, check_rows, option

VIDEO_CHOICES = ("none", "failed", "all", "first")
"""`first` is the last iteration of the first seed of each task and agent."""

ENGINES = ("auto", "processes", "threads", "ray")


@dataclass(frozen=True, kw_only=True)
class Settings:
    """How jobs are run.

    Attributes:
        video_methods: methods that are filmed; None means all.
        fresh: forget the records and videos that the folder holds.
    """

    video: str = option(
        "none", "none, failed, all, or first: the first seed's scored episode.", Choice(VIDEO_CHOICES)
    )
    engine: str = option(
        "auto", "auto (threads if models are asked, else processes), processes, threads or ray.", Choice(ENGINES)
    )
    address: str | None = option(None, "Address of a Ray cluster; by default one is started on this machine.")
    workers: int | None = option(
        1, "Jobs at the same time; 0: one by one, in this process. Default: one per core, 16 threads.",
        Whole(valid="a whole number, 0 (in this process) or more"), flag="--jobs -j", open=True,
    )  # fmt: skip
    job_seconds: float | None = option(
        None,
        "Maximum wall time of a job; then it fails. Default: 3600, or 86400 if models or people are asked.",
        Real(0.001, 1e9),
    )
    optimum: bool = option(False, "Also search for each episode's shortest plan.", Switch())
    extensions: tuple[str, ...] = option(
        (), "Module or file.py that registers tasks; may be repeated.", Texts(), flag="--import"
    )
    preflight: bool = option(
        False, "Ask each model one tiny question first, and say what the run may cost.", Switch(), group="models"
    )
    video_methods: tuple[str, ...] | None = None
    fresh: bool = False

    def __post_init__(self) -> None:
        """Refuse what is not offered, and what does not go together.

        Raises:
            UnknownNameError, OptionError, UsageError: naming what is valid.
        """
        check_rows(self)
        if self.address is not None and self.engine != "ray":
            raise UsageError(f"address {self.address!r} is for --engine ray, not for {self.engine!r}")
