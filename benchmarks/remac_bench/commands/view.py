"""`remac view`: a run's pages in the browser, while it goes on and after."""

from __future__ import annotations

from typing import Annotated

import typer

from remac_bench.flags import takes


@takes("serving.port")
def view(
    folder: Annotated[str, typer.Argument(help="The --out of a run, which may be under way.")], *, port: int
) -> None:
    """Serve the pages of a folder on this machine's loopback, with live progress, until Ctrl-C. Writes nothing."""
    from pathlib import Path

    from remac_bench.errors import UsageError

    if not Path(folder).is_dir():
        raise UsageError(f"there is no folder {folder!r}; give the --out of a `remac bench run`, or of `remac demo`")
    from remac_bench.live.serving import Server
    from remac_bench.live.viewing import View

    server = Server(View(folder).app, port=port)
    typer.echo(f"{server.address}\nCtrl-C ends it.")
    server.run()
