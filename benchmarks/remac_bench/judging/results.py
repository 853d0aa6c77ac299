"""The results: every metric of every agent, a row a task and one over all tasks, a sheet a setting."""

from __future__ import annotations

from collections.abc import Sequence

from remac_bench.board import Cell, Column, Sheet
from remac_bench.judging.cells import Cells, count, interval, money, number, only_known, percent, rate, word
from remac_bench.metrics import ALL_TASKS, Row
from remac_bench.playing import agents

COLUMNS: tuple[Column, ...] = (
    Column(key="task", title="Task", numeric=False),
    Column(key="agent", title="Method", numeric=False, help="method, in brackets where it departs from its defaults"),
    Column(key="n", title="n", help="scored episodes"),
    Column(key="problems", title="Problems", help="distinct problems: starts alike but for looks and names"),
    Column(key="tsr", title="TSR", help="task success rate: the goal holds at the end"),
    Column(key="interval", title="95%", help="Wilson's 95% interval of the TSR"),
    Column(key="scr", title="SCR", help="rounds done of the final plans over their lengths, pooled"),
    Column(key="seconds", title="Time s", help="simulated seconds, mean over successes"),
    Column(key="ipl", title="IPL", help="rounds of the first plan, mean over successes"),
    Column(key="fpl", title="FPL", help="rounds of the final plan, mean over successes"),
    Column(key="crashed", title="Crashed", help="failures by an exception of the agent"),
    Column(key="infrastructure", title="Infra", help="jobs not scored; the next run plays them again"),
    Column(key="tries", title="Tries", help="episodes per job, the scored one included: the agent's budget"),
    Column(key="progress", title="Goal", help="mean fraction of the goal's parts that hold at the end"),
    Column(key="scr_all", title="SCR all", help="mean of each episode's SCR, 0 if no plan was left"),
    Column(key="seconds_all", title="Time all", help="the same with failures at the cap"),
    Column(key="ipl_all", title="IPL all", help="the same with failures at the cap"),
    Column(key="fpl_all", title="FPL all", help="the same with failures at the cap"),
    Column(key="rounds", title="Rounds", help="rounds played, mean over successes"),
    Column(key="rounds_all", title="Rounds all", help="the same with failures at the cap"),
    Column(key="optimum", title="/best", help="rounds over those of the shortest plan, mean over successes"),
    Column(key="optimum_all", title="/best all", help="the same with failures at the cap"),
    Column(key="speedup", title="Speed-up", help="one robot's shortest plan over rounds played by the team"),
    Column(key="best_speedup", title="possible", help="the same for the team's shortest plan"),
    Column(key="idle", title="Idle", help="share of the robots' simulated time in which they wait"),
    Column(key="contacts", title="Contacts", help="control steps per episode in which robots touched"),
    Column(key="near_misses", title="Near", help="control steps per episode in which robots were within 0.05 m"),
    Column(key="calls", title="Calls", help="calls of language models per job, all its iterations"),
    Column(key="tokens", title="Tokens", help="tokens per job, prompts and answers"),
    Column(key="money", title="USD", help="US dollars per job; + if some calls have no known price"),
    Column(key="wall", title="Wall s", help="seconds of wall time per job"),
)

CAPTION = (
    'Columns with "all" count a failure at the cap: max_rounds rounds, each as long as the longest skill takes by the '
    "skill table; the others are means over successes. Calls, tokens, money and wall time are of a job with all its "
    "iterations. Crashed episodes are failures; jobs under Infra are not scored and are run again. SCR counts rounds "
    "of plans and TSR episodes: SCR is above TSR where failed episodes had done part, or all, of their plans, and "
    "below it where the goal was reached before the plan's end, or long plans failed more often."
)


def results_sheets(rows: Sequence[Row], over_all: Sequence[Row], *, folder: str) -> list[Sheet]:
    """One sheet for each setting, in the order of the rows; tasks first, then all of them together."""
    settings = list(dict.fromkeys(row.setting for row in rows))
    return [
        _sheet(
            where,
            [row for row in (*rows, *over_all) if row.setting == where],
            key="results" if len(settings) == 1 else f"results-{number_}",
            folder=folder,
        )
        for number_, where in enumerate(settings, start=1)
    ]


def _sheet(where: str, rows: Sequence[Row], *, key: str, folder: str) -> Sheet:
    controls = {row.tries for row in rows if agents.is_control(row.method)}
    alone = sorted({row.agent for row in rows if agents.is_learner(row.method) and row.tries not in controls})
    missing = (
        f" No control with as many tries is there for {', '.join(alone)}: run BASE-BEST and CC-BEST." if alone else ""
    )
    return Sheet(
        key=key,
        title=f"Results: {where}",
        caption=CAPTION + missing,
        command=f"remac bench report {folder} --all",
        columns=COLUMNS,
        rows=tuple(cells(row) for row in rows),
        facts=tuple(facts(row) for row in rows),
    )


def facts(row: Row) -> dict[str, str]:
    """What pages filter by."""
    starts = row.setting.partition(" starts")[0].rpartition(", ")[2]
    return {
        "task": row.task,
        "method": row.method,
        "agent": row.agent,
        "robots": str(row.robots),
        "starts": starts,
        "setting": row.setting,
    }


def cells(row: Row) -> Cells:
    """A row of `metrics` as cells."""
    plain = {
        name: number(getattr(row, name))
        for name in ("seconds", "seconds_all", "ipl", "ipl_all", "fpl", "fpl_all", "rounds", "rounds_all", "calls")
    }
    ratios = {name: number(getattr(row, name), 2) for name in ("optimum", "optimum_all", "speedup", "best_speedup")}
    return only_known(
        {
            "task": word(row.task, note=f"{row.tasks} tasks" if row.task == ALL_TASKS else ""),
            "agent": word(row.agent, note=_note(row)),
            "n": count(row.n),
            "problems": count(row.problems),
            "tsr": rate(row.successes, row.n),
            "interval": interval(row.low, row.high),
            **plain,
            **ratios,
            "scr": percent(row.scr, note=_scr_note(row)),
            "scr_all": percent(row.scr_all),
            "progress": percent(row.progress),
            "idle": percent(row.idle),
            "contacts": number(row.contacts),
            "near_misses": number(row.near_misses),
            "tokens": number(row.tokens, 0),
            "money": money(row.money, unpriced=row.unpriced),
            "wall": number(row.wall),
            "tries": count(row.tries),
            "crashed": _alarm(row.crashed),
            "infrastructure": _alarm(row.infrastructure),
        }
    )


def _alarm(value: int) -> Cell:
    return count(value, note="look at `error` in the records" if value else "")


def _scr_note(row: Row) -> str:
    """Why the share of plans that was done is not the share of episodes that succeeded, where they differ."""
    if row.scr is None or row.tsr is None or f"{row.scr:.2f}" == f"{row.tsr:.2f}":
        return ""
    if row.scr > row.tsr:
        return "above TSR: episodes that failed had done part, or all, of their plans"
    return "below TSR: goals were reached with rounds of the final plan undone, or long plans failed more often"


def _note(row: Row) -> str:
    if agents.is_control(row.method):
        return f"control: the best of {row.tries} tries, nothing learnt from one to the next"
    return f"{row.tries} tries a job, learning" if agents.is_learner(row.method) else ""
